"""The language of a text is told, or the text is refused as a guess."""

from __future__ import annotations

import pytest

from lipwright.errors import LipwrightError
from lipwright.language.codes import NAMES, OURS
from lipwright.language.detect import check_language, detect_language
from lipwright.language.frequent_words import ALPHABETS, FREQUENT_WORDS
from lipwright.language.scripts import SCRIPTS_OF, USUAL, count_scripts, script_of

# Lines such as games, lessons and talks have; written for this test.
SENTENCES = {
    "en": """Where did you put the keys to the old car?
        The enemy is coming, get behind the wall!
        I never thought we would see the ocean again.
        Please tell your mother that dinner is ready.
        Bin blue at f two now.
        She sells sea shells by the sea shore.
        Rain fell all night, and the river rose.
        What a beautiful morning!
        Nobody knows how the story ends.
        My name is Peter and this is my brother.""",
    "sv": """Var har du lagt nycklarna till den gamla bilen?
        Fienden kommer, göm dig bakom muren!
        Jag trodde aldrig att vi skulle få se havet igen.
        Säg till din mor att maten är klar.
        Sju sjösjuka sjömän sköttes av sköna sjuksköterskor.
        Det regnade hela natten och älven steg.
        Vilken vacker morgon!
        Ingen vet hur berättelsen slutar.
        Jag heter Peter och det här är min bror.
        Flyget, tåget och bilbranschen tävlar om lönsamhet.""",
    "de": """Wo hast du die Schlüssel für das alte Auto hingelegt?
        Der Feind kommt, geh hinter die Mauer!
        Ich hätte nie gedacht, dass wir das Meer wiedersehen.
        Sag deiner Mutter bitte, dass das Essen fertig ist.
        Es regnete die ganze Nacht, und der Fluss stieg.
        Was für ein schöner Morgen!
        Niemand weiß, wie die Geschichte endet.
        Ich heiße Peter, und das ist mein Bruder.
        Fischers Fritz fischt frische Fische.
        Könnten Sie mir helfen?""",
    "es": """¿Dónde has puesto las llaves del coche viejo?
        ¡Viene el enemigo, ponte detrás del muro!
        Nunca pensé que volveríamos a ver el mar.
        Dile a tu madre que la cena está lista.
        Llovió toda la noche y el río creció.
        ¡Qué mañana tan bonita!
        Nadie sabe cómo termina la historia.
        Me llamo Pedro y este es mi hermano.
        Tres tristes tigres tragaban trigo en un trigal.
        La casa es grande.""",
    "fr": """Où as-tu mis les clés de la vieille voiture ?
        L'ennemi arrive, cache-toi derrière le mur !
        Je n'aurais jamais cru que nous reverrions la mer.
        Dis à ta mère que le dîner est prêt.
        Il a plu toute la nuit et la rivière a monté.
        Quelle belle matinée !
        Personne ne sait comment l'histoire se termine.
        Je m'appelle Pierre et voici mon frère.
        Les chaussettes de l'archiduchesse sont-elles sèches ?
        Pouvez-vous m'aider ?""",
    "it": """Dove hai messo le chiavi della vecchia macchina?
        Arriva il nemico, mettiti dietro il muro!
        Non avrei mai pensato che avremmo rivisto il mare.
        Di' a tua madre che la cena è pronta.
        Ha piovuto tutta la notte e il fiume è salito.
        Che bella mattina!
        Nessuno sa come finisce la storia.
        Mi chiamo Pietro e questo è mio fratello.
        Trentatré trentini entrarono a Trento.
        Può aiutarmi, per favore?""",
    "nl": """Waar heb je de sleutels van de oude auto gelegd?
        De vijand komt eraan, ga achter de muur staan!
        Ik had nooit gedacht dat we de zee weer zouden zien.
        Zeg tegen je moeder dat het eten klaar is.
        Het regende de hele nacht en de rivier steeg.
        Wat een mooie ochtend!
        Niemand weet hoe het verhaal afloopt.
        Ik heet Peter en dit is mijn broer.
        De kat krabt de krullen van de trap.
        Kunt u mij helpen?""",
    "pt": """Onde você colocou as chaves do carro velho?
        O inimigo está chegando, fique atrás do muro!
        Nunca pensei que veríamos o mar outra vez.
        Diga à sua mãe que o jantar está pronto.
        Choveu a noite toda e o rio subiu.
        Que manhã tão bonita!
        Ninguém sabe como a história termina.
        Eu me chamo Pedro e este é o meu irmão.
        O rato roeu a roupa do rei de Roma.
        Pode me ajudar, por favor?""",
    "cmn": """你把旧车的钥匙放在哪里了？
        敌人来了，快躲到墙后面去！
        我從來沒想過我們還能再看到大海。
        nǐ hǎo, wǒ jiào lǐ míng.
        ni3 hao3, wo3 shi4 zhong1guo2 ren2
        Wǒmen míngtiān qù Běijīng.""",
    "ja": """ふるい くるまの かぎを どこに おきましたか。
        敵が来た、壁の後ろに隠れろ！
        コーヒーをください。
        YouTubeで見た""",
    "fi": """Mihin laitoit vanhan auton avaimet?
        En olisi koskaan uskonut, että näemme meren taas.
        Minun nimeni on Pekka ja tämä on veljeni.""",
    "pl": """Gdzie położyłeś klucze do starego samochodu?
        Nikt nie wie, jak kończy się ta historia.
        Mam na imię Piotr, a to jest mój brat.""",
    "da": """Hvor har du lagt nøglerne til den gamle bil?
        Ingen ved, hvordan historien ender.
        Jeg hedder Peter, og det her er min bror.""",
    "tr": """Eski arabanın anahtarlarını nereye koydun?
        Hikâyenin nasıl bittiğini kimse bilmiyor.""",
    "ru": """Куда ты положил ключи от старой машины?
        Никто не знает, чем кончается история.""",
    "uk": """Куди ти поклав ключі від старої машини?
        Ніхто не знає, як закінчується ця історія.""",
    "ar": """أين وضعت مفاتيح السيارة القديمة؟
        لا أحد يعرف كيف تنتهي القصة""",
    "hi": """तुमने पुरानी गाड़ी की चाबियाँ कहाँ रखीं?
        कोई नहीं जानता कि कहानी कैसे खत्म होती है।""",
    "ko": "안녕하세요, 제 이름은 민수입니다.",
    "el": "Πού έβαλες τα κλειδιά του παλιού αυτοκινήτου;",
    "he": "איפה שמת את המפתחות של המכונית הישנה?",
    "th": "คุณวางกุญแจรถคันเก่าไว้ที่ไหน",
    "yue": "你將架舊車嘅鎖匙擺咗喺邊度？",
}  # fmt: skip
LINES = [(code, line.strip()) for code, lines in SENTENCES.items() for line in lines.split("\n")]


@pytest.mark.parametrize(("code", "text"), LINES)
def test_sentences_are_told_or_refused_and_never_taken_for_another(code: str, text: str) -> None:
    try:
        found, confidence = detect_language(text)
    except LipwrightError:
        assert code not in ("cmn", "ja")
    else:
        assert (found, 0.6 <= confidence <= 1) == (code, True)


def test_nearly_every_sentence_is_told() -> None:
    refused = []
    for code, text in LINES:
        try:
            detect_language(text)
        except LipwrightError:
            refused.append((code, text))
    assert len(refused) <= 0.04 * len(LINES), refused


@pytest.mark.parametrize(
    ("code", "text"),
    [
        ("en", "Hello there."), ("en", "Yes, please!"), ("sv", "Hur mår du?"), ("de", "Guten Tag!"),
        ("fr", "Bonjour !"), ("it", "Ciao!"), ("pt", "Obrigado!"), ("es", "¡Buenos días!"),
        ("nl", "Dank je wel!"), ("ja", "こんにちは"), ("cmn", "你好"), ("cmn", "nǐ hǎo"),
        ("cmn", "Ni3 hao3!"),
    ],
)  # fmt: skip
def test_greetings_are_told(code: str, text: str) -> None:
    assert detect_language(text)[0] == code


@pytest.mark.parametrize("text", ["Nunca pensé", "Où", "Può", "Diga à", "Voilà"])
def test_accents_alone_do_not_make_pinyin(text: str) -> None:
    try:
        assert detect_language(text)[0] != "cmn"
    except LipwrightError as error:
        assert text in str(error)  # noqa: PT017 - either is right


@pytest.mark.parametrize("text", ["OK", "Taxi", "Peter", "La", "a", "no"])
def test_a_word_of_many_languages_is_a_guess(text: str) -> None:
    with pytest.raises(LipwrightError, match=r"cannot tell the language of .* --language"):
        detect_language(text)


@pytest.mark.parametrize("text", ["", "  \n", "123 456", "😀 👍", "?!", "\x00\x07"])
def test_a_text_without_letters_has_no_language(text: str) -> None:
    with pytest.raises(LipwrightError, match=r"lines\.txt: has no letters"):
        detect_language(text, source="lines.txt")


def test_only_the_languages_asked_for_are_told() -> None:
    text = "Where did you put the keys to the old car?"
    assert detect_language(text, among=("en", "fr"))[0] == "en"
    assert detect_language("你好", among=("ja", "en"))[0] == "ja"
    with pytest.raises(LipwrightError, match="cannot tell"):
        detect_language("Привет, как дела?", among=("en", "fr"))


def test_a_long_text_costs_no_more() -> None:
    assert detect_language("This is the same sentence again and again. " * 20_000)[0] == "en"


def test_a_foreign_name_does_not_change_the_language() -> None:
    assert detect_language("The word 你好 is what they say when they meet you.")[0] == "en"


@pytest.mark.parametrize(("code", "text"), LINES)
def test_a_text_of_the_language_named_is_fine(code: str, text: str) -> None:
    assert check_language(text, code) == ""


@pytest.mark.parametrize("code", ["en", "en-gb", "sv", "de", "es", "fr", "it", "nl", "pt", "fi"])
def test_other_letters_than_the_language_has_are_refused_with_their_place(code: str) -> None:
    with pytest.raises(
        LipwrightError,
        match=r"a\.txt: line 2, column 4: 'Привет, как дела\?' is written in Cyrillic letters, "
        rf"which {NAMES[code].replace('(', '.').replace(')', '.')} is not; .* such as ru with",
    ):
        check_language("Ja!\n – Привет, как дела?", code, "a.txt")


@pytest.mark.parametrize(
    ("text", "code", "script"),
    [
        ("你好，世界", "en", "Chinese characters"), ("こんにちは", "cmn", "kana"),
        ("Hello there", "ja", "Latin letters"), ("안녕하세요", "ja", "Hangul letters"),
        ("Πού είσαι", "ru", "Greek letters"),
    ],
)  # fmt: skip
def test_scripts_are_named(text: str, code: str, script: str) -> None:
    with pytest.raises(LipwrightError, match=f"is written in {script}"):
        check_language(text, code)


def test_another_language_in_the_same_letters_is_a_warning() -> None:
    note = check_language("Wo hast du die Schlüssel für das alte Auto hingelegt?", "en", "the text")
    assert note == "the text looks German, not English; if it is, use --language de"
    assert "looks English" in check_language(SENTENCES["en"], "sv")
    assert "Latin letters, which Russian is not" in check_language("Privet, kak dela?", "ru")


def test_a_few_foreign_words_are_no_warning() -> None:
    assert check_language("He said guten Tag to the man at the door.", "en") == ""
    assert check_language("The word 你好 means hello.", "en-gb") == ""
    assert check_language("Taxi!", "sv") == check_language("123", "sv") == ""


def test_tables_name_nothing_that_does_not_exist() -> None:
    assert {*FREQUENT_WORDS} <= {*NAMES}
    assert {*ALPHABETS} == {*OURS} - {"en-gb", "cmn", "ja"}
    assert {*USUAL.values()} <= {*NAMES}
    assert {*SCRIPTS_OF} == {*NAMES}
    scripts = {script for row in SCRIPTS_OF.values() for script in row}
    assert all(SCRIPTS_OF[code][0] == script for script, code in USUAL.items())
    assert scripts == {script_of(char) for char in (
        "a", "α", "я", "ա", "א", "ع", "अ", "অ", "ਅ", "અ", "ଅ", "அ", "అ", "ಅ", "അ", "අ", "ก", "က",
        "ა", "한", "አ", "Ꭰ", "漢", "か", "\uf8d0", "𐑐",
    )}  # fmt: skip


def test_words_of_an_alphabet_are_spelt_in_it() -> None:
    for code, letters in ALPHABETS.items():
        own = {char for word in FREQUENT_WORDS[code] for char in word if char > "z"}
        assert own <= set(letters), code


def test_characters_weigh_as_the_words_that_they_are() -> None:
    assert count_scripts("漢字 abc1!") == {"Han": 6, "Latin": 3}
