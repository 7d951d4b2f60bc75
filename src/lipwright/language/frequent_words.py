"""The words that every text of a language is full of, to tell languages apart at once.

About the fifty most frequent words of spoken language (subtitles) in each, and what short lines
begin and end with: greetings, thanks, yes and no. Neighbours that share many words with one of
ours stand beside them, so that Danish is not taken for Swedish.
"""

from __future__ import annotations

from types import MappingProxyType
from typing import Final

# fmt: off
_TEXT: Final = MappingProxyType({
    "en": """the be is are was were to of and a in that have has had it its it's i i'm you he she
        we they me my your his her our their this not don't can't do does did what for on
        with as at by from or but an if so all will would can could there when who how where
        why just about up out get go know like yes no hello hi hey thanks thank please sorry
        good okay well been one here now then than them him us too come let's right""",
    "sv": """och att det som en ett på är av för med den till inte om har de jag du vi han hon
        var men så sig vad kan mig dig min din ska nu här då när där hur ut upp från eller
        bara alla mycket vill måste finns få får ja nej hej tack snälla förlåt bra gör mitt
        vara blir blev oss er ni något någon varför vem över efter hade skulle kom också""",
    "de": """und der die das ist ich nicht du es sie wir ein eine einen einem den dem des zu in
        mit auf für von was er ihr sich auch wie so aber mich mir dich dir ja nein hallo
        danke bitte hier da noch nur wenn hat habe haben bin sind war wird werden kann muss
        alles gut doch nach bei aus um an als oder mein dein sein uns über jetzt schon warum
        wo wer tag im am zum guten heute sehr""",
    "es": """el la los las de que y a en un una es no se por con para su lo como más pero le mi
        te tu al del si sí está esto eso yo ya muy qué me nos hay todo bien aquí hola
        gracias adiós señor cuando donde dónde cómo quién ella ellos usted ser estoy están
        tengo tiene vamos puede porque también fue era son sus este esta buenos días favor
        hoy""",
    "fr": """le la les de des du un une et est il elle je tu nous vous ils on que qui ne pas ce
        c'est j'ai dans en à au aux pour sur avec plus par mais où se sa son ses mon ma mes
        ton ta votre être avoir suis es a ont sont était fait tout bien oui non bonjour
        merci salut très comme si ça cette cet rien ici quand pourquoi comment leur y moi
        toi lui peut faut plaît deux""",
    "it": """il lo la i gli le di che e è un una uno non per con da in del della dei delle al
        alla nel nella si mi ti ci ma come più sono ho hai ha abbiamo era questo questa
        quello io tu lui lei noi cosa bene sì no ciao grazie prego perché anche se su dove
        quando chi tutto tutti molto qui ora solo essere fatto stato suo mio tuo vuoi posso
        deve buongiorno oggi sei""",
    "nl": """de het een en van ik is dat niet je in te we op er met voor zijn ze die hij wat maar
        aan was dit mijn naar om als hebben heb heeft ook er nog wel kan jij u zij wij bij
        zo of door nu moet hier daar waar wie hoe waarom goed ja nee hallo dank bedankt dag
        alstublieft gaan komt weet wil dan uit over deze geen mij jou hem haar ons worden
        gaat alles iets niets""",
    "pt": """o a os as de que e é um uma não em do da dos das no na para por com se eu você ele
        ela nós eles isso isto está estou como mais mas bem muito sim olá oi obrigado
        obrigada tudo aqui meu minha seu sua foi ser tem tenho vai vou ao à também já quando
        onde quem porque por só me te lhe nos são era há pode este esta esse bom dia hoje
        ter""",
    # neighbours
    "da": """og at det er en et på af for med den til ikke om har de jeg du vi han hun var men så
        sig hvad kan mig dig min din skal nu her da når hvor ud op fra eller bare alle meget
        vil må ja nej hej tak god være bliver blev os noget nogen hvorfor hvem efter havde
        skulle kom også""",
    "nb": """og at det er en et på av for med den til ikke om har de jeg du vi han hun var men så
        seg hva kan meg deg min din skal nå her da når hvor ut opp fra eller bare alle mye
        vil må ja nei hei takk god være blir ble oss noe noen hvorfor hvem etter hadde
        skulle kom også""",
    "ca": """el la els les de que i a en un una és no es per amb seu ho com més però li meu et al
        del si sí està això jo ja molt què em ens hi ha tot bé aquí hola gràcies adéu quan
        on qui ella ser són aquest aquesta també va""",
    "ro": """și de la în nu un o este e cu pe că din pentru să ce mai am ai are sunt eu tu el ea
        noi voi ei lui te mă ne se da bine bună mulțumesc ca dar unde când cine acum aici
        foarte""",
    "fi": """ja on ei se että en hän mutta oli ole minä sinä me te he kun niin kuin mitä tämä
        olen olet nyt vain jos kiitos hei kyllä hyvää päivää anteeksi missä miksi kuka joka
        myös""",
    "pl": """i w nie na się z do to że jest jak co po tak ale o za od mnie ja ty on ona my wy dla
        czy tym już tylko był ma są dzień dobry cześć dziękuję proszę gdzie kiedy dlaczego
        kto""",
    "cs": """a v se na je že to s z do i o jsem jsi ne ale jak co po tak by pro já ty on ona my
        vy jsou ve si už jen byl dobrý den ahoj děkuji prosím kde kdy proč kdo není""",
    "tr": """ve bir bu da de ne için mi o ben sen biz siz çok daha var yok evet hayır ama gibi
        kadar ile olarak değil nasıl nerede neden merhaba teşekkürler lütfen şey her iyi""",
    "id": """yang dan di ini itu tidak dengan untuk dari saya kamu dia kami kita ada akan apa ke
        bisa sudah anda juga pada adalah terima kasih selamat pagi ya bukan mereka""",
    "af": """die is en van in nie het ek jy dat te op vir met wat hy sy ons hulle maar aan was
        dit my jou om as ook nog wel kan by so of deur nou moet hier daar waar wie hoe goed
        dankie""",
    "hu": """a az és hogy nem is egy ez van volt de meg csak ha már mi te én ő igen köszönöm
        kérem szia jó napot itt hol mikor miért ki mert vagy lesz kell""",
})
# fmt: on

FREQUENT_WORDS: Final = MappingProxyType(
    {code: frozenset(text.split()) for code, text in _TEXT.items()}
)
"""code to its most frequent words, in lower case"""

ALPHABETS: Final = MappingProxyType({
    "en": "", "sv": "åäöé", "de": "äöüß", "es": "áéíóúüñ", "fr": "àâæçéèêëîïôœùûüÿ",
    "it": "àèéìíîòóùú", "nl": "éëïöüáóèê", "pt": "áâãàçéêíóôõúü",
})  # fmt: skip
"""code to the letters of its own words besides a to z; only of our own languages"""
