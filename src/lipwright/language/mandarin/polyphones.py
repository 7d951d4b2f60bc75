"""Characters with several readings: which they have, and which one stands where.

Readings by the "Xiandai Hanyu Cidian" and the "Putonghua yiduci shenyinbiao" (1985), without
tones, as those do not show; readings of names of places and persons and of old books are left
out. Phrases of the lexicon go before all of this.
"""

from __future__ import annotations

import re
from types import MappingProxyType
from typing import Final

POLYPHONES: Final = MappingProxyType({
    # of grammar, in nearly every text
    "的": "de di", "了": "le liao", "着": "zhe zhao zhuo", "得": "de dei", "地": "di de",
    "还": "hai huan", "都": "dou du", "没": "mei mo", "和": "he huo hu", "给": "gei ji",
    "呢": "ne ni", "么": "me", "谁": "shei shui", "这": "zhe zhei", "那": "na nei", "哪": "na nei",
    "什": "shen shi", "俩": "lia liang", "嗯": "en ng", "喔": "o wo", "哦": "o e",
    "哟": "yo", "诶": "ei ê", "欸": "ei ê", "噢": "o ao", "嘞": "lei le", "咯": "lo ge",
    "幺": "yao yi", "咱": "zan",
    # verbs, nouns and adjectives
    "长": "chang zhang", "行": "xing hang", "重": "zhong chong", "乐": "le yue", "觉": "jue jiao",
    "角": "jiao jue", "率": "lü shuai", "朝": "chao zhao", "传": "chuan zhuan", "弹": "tan dan",
    "调": "tiao diao", "降": "jiang xiang", "藏": "cang zang", "曾": "ceng zeng",
    "单": "dan shan chan", "差": "cha chai ci", "参": "can shen cen",
    "会": "hui kuai", "系": "xi ji", "校": "xiao jiao", "血": "xie xue", "模": "mo mu",
    "薄": "bao bo", "剥": "bo bao", "壳": "ke qiao", "折": "zhe she",
    "似": "si shi", "宿": "su xiu", "尉": "wei yu",
    "吓": "xia he", "解": "jie xie", "落": "luo lao la", "露": "lu lou",
    "秘": "mi bi",
    "屏": "ping bing", "朴": "pu piao", "强": "qiang jiang", "茄": "qie jia",
    "伽": "jia qie ga", "塞": "sai se", "厦": "sha xia", "杉": "shan sha",
    "省": "sheng xing", "盛": "sheng cheng", "熟": "shu shou",
    "拓": "tuo ta", "纤": "xian qian", "削": "xiao xue", "咽": "yan ye",
    "钥": "yao yue", "择": "ze zhai", "粘": "zhan nian", "爪": "zhua zhao",
    "车": "che ju", "臭": "chou xiu", "畜": "chu xu", "阿": "a e",
    "扁": "bian pian", "便": "bian pian", "泊": "bo po", "卜": "bu bo",
    "刹": "sha cha", "禅": "chan shan", "颤": "chan zhan", "匙": "chi shi", "澄": "cheng deng",
    "仇": "chou qiu", "佛": "fo fu", "否": "fou pi", "脯": "fu pu", "咖": "ka ga",
    "芥": "jie gai", "龟": "gui jun qiu", "核": "he hu", "贾": "jia gu", "劲": "jin jing",
    "卡": "ka qia", "咳": "ke hai", "烙": "lao luo", "勒": "le lei", "抹": "mo ma",
    "埋": "mai man", "脉": "mai mo", "蔓": "man wan", "娜": "na nuo", "胖": "pang pan",
    "刨": "bao pao", "曝": "pu bao", "区": "qu ou", "圈": "quan juan", "吁": "xu yu",
    "扎": "zha za", "轧": "zha ya", "吗": "ma", "磅": "bang pang", "扛": "kang gang",
    "仔": "zi zai", "蛤": "ha ge", "吭": "keng hang",
    "攒": "zan cuan", "椎": "zhui chui",
    "嚼": "jiao jue", "豁": "huo hua", "辟": "pi bi", "柏": "bai bo", "堡": "bao pu bu",
    "柚": "you zhou", "熨": "yun yu", "肋": "lei le", "栅": "zha shan", "虾": "xia ha",
    "夯": "hang", "桔": "ju jie", "伺": "si ci", "腌": "yan a", "拗": "ao niu", "槛": "kan jian",
    "莞": "wan guan", "氓": "mang meng", "侗": "dong tong", "纶": "lun guan", "喳": "zha cha",
    "著": "zhu zhe zhao zhuo", "乾": "gan qian", "碌": "lu liu", "囤": "tun dun",
    "镐": "gao hao", "呱": "gua gu", "凹": "ao wa",
    "咋": "za ze zha", "疟": "nüe yao",
    "瀑": "pu bao", "绰": "chuo chao",
})  # fmt: skip
"""simplified character to its readings, the most usual of it alone first"""

_VERBS: Final = (
    "走去来做说看想吃喝买听写等问找学干回上下用把跟先让给在有是要能会赶加打开穿拿带坐站睡起"
)

CONTEXTS: Final = tuple(
    (char, re.compile(f"(?:{before})$"), re.compile(after), reading)
    for char, before, after, reading in (
        # must: after a subject or an adverb, before a verb
        ("得", "[我你您他她它咱们人家总非还就都也必只可又]", f"[{_VERBS}]", "dei"),
        ("得", "", "马上|赶紧|赶快|好好|注意|小心|尽快|立刻", "dei"),
        ("得", "[今明后每]天|晚上|现在|以后|之后|情", "[^到了很好快太不多]", "dei"),
        # -ly: after a repeated or a longer word, before what is done
        ("地", "(.)\\1|[^\\s这那本该各此某异当土]{2}",
         "[^\\W\\da-zA-Z上下里面板图点区位球铁主址狱带块毯方道的了是在]", "de"),
        # give back
        ("还", "", "(?:了|给|钱|书|债|款|清|账|贷|我[钱书]|你[钱书]|他[钱书])", "huan"),
        ("还", "[要来去已归偿]", "(?:了|$|\\W)", "huan"),
        # can and cannot, finish
        ("了", "[^\\s][不]|[^\\s][做吃受免办管少去走来]得", "", "liao"),
        # reach, catch, asleep
        ("着", "[睡找见猜点够逮捞买碰摸]|[睡找猜点够逮捞买碰摸]不|[睡找猜点够逮捞买碰摸]得",
         "(?:了|吗|$|\\W)", "zhao"),
        ("着", "", "[火凉急迷慌]", "zhao"),
        ("着", "", "[装陆手眼重力色落]", "zhuo"),
        # grow; head of
        ("长", "[生成增助滋见疯市校省部院会局处科班组队站所厂社船村镇县州董理军师]"
         "|[团连排店馆台庭区乡]", "", "zhang"),
        ("长", "", "[大高胖得着了出满肉个势相在]", "zhang"),
        # rows, trades and firms; a number before
        ("行", "[一二两三四五六七八九十百千几每同本内外各银分支总商]",
         "(?![了吗吧不动为走人驶李程星使])", "hang"),
        # again; layers
        ("重", "", "[新来做写复返建申组启演现逢温读拍播修订合叠庆阳聚装]", "chong"),
        ("重", "[一二两三四五六七八九十百千双多几]", "", "chong"),
        ("都", "[首成故古旧建定帝国]", "", "du"),
        ("都", "", "[市城会]", "du"),
        ("乐", "[音声器民奏配弦国摇]", "", "yue"),
        ("觉", "[睡午补懒一个]", "(?!得|悟|醒|察)", "jiao"),
        ("朝", "[今明]|三", "", "zhao"),
        ("弹", "[子炮导炸枪核氢榴流中飞防催泪]", "", "dan"),
        ("弹", "", "[药头道壳片坑弓丸]", "dan"),
        ("调", "[强单声音语色格曲论情步基]", "", "diao"),
        ("调", "", "[整节解料和皮味制控试剂戏侃养停频酒低高]", "tiao"),
        ("降", "[投]", "", "xiang"),
        ("差", "[出]", "", "chai"),
        ("系", "", "(?:好|上|鞋|领带|扣|围|安全)", "ji"),
        ("薄", "[淡单浅微菲厚稀轻刻]", "", "bo"),
        ("传", "[自外列正]", "", "zhuan"),
        ("落", "", "(?:在[家车学公办]|下了)", "la"),
        ("率", "", "[领先军直真性众]", "shuai"),
        ("率", "[草轻坦表]", "", "shuai"),
        ("削", "[剥瘦]", "", "xue"),
        ("血", "[心热鲜流出献贫输补止血吐气冷混]", "", "xue"),
        ("血", "", "[液压管型缘统脂糖泪汗案战腥]", "xue"),
        ("没", "[淹埋沉吞出隐湮覆]", "", "mo"),
        ("没", "", "[收落]", "mo"),
        ("模", "", "[样板具]", "mu"),
        ("著", "[^\\W\\da-zA-Z]", "(?![名作者述称])", "zhe"),
        ("和", "[暖搅]", "", "huo"),
    )
)  # fmt: skip
"""character, what stands before and behind it, and its reading there; the first that fits"""

PHRASES: Final = MappingProxyType({
    "大夫": "dai fu", "长江大桥": "chang jiang da qiao", "银行长": "yin hang zhang",
    "一行": "yi hang", "三行": "san hang", "重置": "chong zhi", "重做": "chong zuo",
    "长大后": "zhang da hou", "面包": "mian bao", "视频": "shi pin", "手机": "shou ji",
    "和面包": "he mian bao", "电脑": "dian nao", "旅游": "lü you", "直播": "zhi bo",
    "主播": "zhu bo",
})  # fmt: skip
"""words that the lexicon lacks, or that it reads as old books do"""

TWO_SYLLABLES: Final = (
    "女儿", "婴儿", "幼儿", "孤儿", "少儿", "健儿", "小儿", "胎儿", "生儿", "男儿", "孙儿", "产儿",
    "宠儿", "弃儿", "血儿", "患儿", "育儿", "托儿", "妻儿", "侄儿", "乞儿", "娇儿", "骄儿", "痴儿",
    "能儿", "卖儿", "拖儿", "潮儿", "馨儿", "孩儿", "我儿", "爱儿", "亡儿", "畸儿", "形儿", "死儿",
)  # fmt: skip
"""words at whose end 儿 is a syllable of its own, not the r of erhua"""
