"""Numbers in Mandarin text: dates, times, money, units, telephone numbers; as they are read."""

from __future__ import annotations

import re
from collections.abc import Callable
from re import Match
from types import MappingProxyType
from typing import Final

from lipwright.language.mandarin.numbers import cardinal, digits, number

UNITS: Final = MappingProxyType({
    "km/h": "公里每小时", "m/s": "米每秒", "kWh": "千瓦时", "kHz": "千赫", "MHz": "兆赫",
    "GHz": "吉赫", "Hz": "赫兹", "km": "公里", "cm": "厘米", "mm": "毫米", "nm": "纳米",
    "kg": "公斤", "mg": "毫克", "ml": "毫升", "mL": "毫升", "kW": "千瓦", "MW": "兆瓦",
    "dB": "分贝", "ms": "毫秒", "min": "分钟", "km2": "平方公里", "m2": "平方米", "m3": "立方米",
    "°C": "摄氏度", "°F": "华氏度", "°": "度", "m": "米", "g": "克", "L": "升", "l": "升",
    "h": "小时", "s": "秒", "W": "瓦", "V": "伏", "t": "吨",
})  # fmt: skip
"""behind a number, as written, to how it is read"""

CURRENCIES: Final = MappingProxyType({
    "¥": "元", "￥": "元", "$": "美元", "€": "欧元", "£": "英镑", "₩": "韩元", "₹": "卢比",
    "RMB": "元", "HK$": "港元", "NT$": "新台币",
})  # fmt: skip

SIGNS: Final = MappingProxyType({
    "%": "百分号", "&": "和", "+": "加", "=": "等于", "×": "乘", "÷": "除以", "@": "at",
    "#": "井号", "°": "度", "±": "正负", "≈": "约等于", "<": "小于", ">": "大于",
    "≤": "小于等于", "≥": "大于等于", "$": "美元", "¥": "元", "€": "欧元", "£": "英镑",
})  # fmt: skip
"""a sign between words; those that numbers take are read with them"""

_MEASURES: Final = (
    "个個只隻本张張条條件位把辆輛台臺架座栋棟间間家所匹头頭群双雙对對副套种種样樣类類次遍回趟"
    "场場阵陣顿頓年天周週点點秒岁歲元块塊毛米克吨噸升里斤磅杯瓶碗盘盤箱包袋盒罐口名段句篇封份"
    "部首支枝根颗顆棵朵片粒滴滩堆束串排圈步倍页頁百千万萬亿億门門项項届股则面扇幅层層笔筆人国國"
    "地边邊者手眼"
)
"""what is counted with 两 for two: 2本 is 两本"""
_LONG_MEASURES: Final = (
    "小时|小時|分钟|分鐘|公[里斤尺分]|[厘毫千]米|[毫千]克|毫升|英[里尺寸]|章节|星期|个月|個月|平方"
)
_COUNTED: Final = f"(?:[{_MEASURES}]|{_LONG_MEASURES})"
_NOT_COUNTED: Final = "年级|年級|等|人称|人稱|分之|进制|進位|维|維"  # as in 第二
_N: Final = r"(?:\d{1,3}(?:,\d{3})+|\d+)(?:\.\d+)?|\.\d+"
_UNIT: Final = "|".join(re.escape(unit) for unit in sorted(UNITS, key=len, reverse=True))
_UNIT_END: Final = r"(?![A-Za-z\d])"
_MONEY: Final = "|".join(re.escape(sign) for sign in sorted(CURRENCIES, key=len, reverse=True))
_MAGNITUDE: Final = "[百千十]?[万萬亿億]"
_TO: Final = r"\s?[-~–—]\s?"
_CALL: Final = (
    "(?:电话|電話|热线|熱線|手机|手機|拨打|撥打|号码|號碼|房间|房間|报警|報警|拨|撥|打)[::]?\\s?"
)

Rule = Callable[["Match[str]"], list[str]]


def _two(said: str) -> str:
    return "两" if said == "二" else said


def _digit_words(text: str) -> list[str]:
    return list(digits(text, phone=True))


def _date(found: Match[str]) -> list[str]:
    year, month, day = digits(found["year"]), int(found["month"]), int(found["day"])
    return [year, "年", cardinal(month), "月", cardinal(day), "日"]


def _time(found: Match[str]) -> list[str]:
    hour, minute, second = int(found["hour"]), int(found["minute"]), found["second"]
    words = [_two(cardinal(hour)), "点"]
    if minute or second:
        words += [("零" if 0 < minute < 10 else "") + cardinal(minute), "分"]
    return [*words, cardinal(int(second)), "秒"] if second else words


def _percent(found: Match[str]) -> list[str]:
    part = "百分之" if found["sign"] == "%" else "千分之"
    words = [*_minus(found), part, number(found["number"])]
    return [*words, "到", part, number(found["to"])] if found["to"] else words


def _minus(found: Match[str]) -> list[str]:
    return ["负"] if found["minus"] else []


def _money(found: Match[str]) -> list[str]:
    name = CURRENCIES[found["before"] or found["behind"]]
    return [*_minus(found), *_sum(found["number"], name, found["magnitude"] or "")]


def _sum(text: str, name: str, magnitude: str = "") -> list[str]:
    """An amount of money; with two decimals in yuan, jiao and fen: 5.50 is 五元五角."""
    whole, _, decimals = text.partition(".")
    if name != "元" or magnitude or len(decimals) != 2:
        return [_two(number(text)) + magnitude, name]
    words = [_two(number(whole)), name] if whole.strip("0,") or not decimals.strip("0") else []
    if decimals[0] != "0":
        words += [_two(number(decimals[0])), "角"]
    elif decimals[1] != "0" and words:
        words.append("零")
    return [*words, number(decimals[1]), "分"] if decimals[1] != "0" else words


def _measure(found: Match[str]) -> list[str]:
    unit = UNITS[found["unit"].replace("²", "2").replace("³", "3")]
    below = found["minus"] and unit in ("摄氏度", "华氏度")
    sign = ["零下"] if below else _minus(found)
    words = [*sign, _two(number(found["number"]))]
    if found["to"]:
        words += ["到", _two(number(found["to"]))]
    return [*words, unit]


def _fraction(found: Match[str]) -> list[str]:
    whole = [cardinal(int(found["whole"])), "又"] if found["whole"] else []
    return [*whole, cardinal(int(found["below"])), "分之", cardinal(int(found["above"]))]


def _ratio(found: Match[str]) -> list[str]:
    return [number(found["one"]), "比", number(found["other"])]


def _range(found: Match[str]) -> list[str]:
    return [number(found["one"]), "到", number(found["other"])]


def _year(found: Match[str]) -> list[str]:
    words = [digits(found["year"])]
    return [*words, "到", digits(found["to"])] if found["to"] else words


def _version(found: Match[str]) -> list[str]:
    first, *rest = found[0].split(".")
    return [number(first)] + [word for part in rest for word in ("点", number(part))]


_RULES: Final[tuple[tuple[re.Pattern[str], Rule], ...]] = tuple(
    (re.compile(pattern, re.ASCII), rule)
    for pattern, rule in (
        (r"(?P<year>[12]\d{3})(?P<mark>[-/.])(?P<month>0?[1-9]|1[012])(?P=mark)"
         r"(?P<day>[12]\d|3[01]|0?[1-9])(?!\d)", _date),
        (r"(?P<hour>[01]?\d|2[0-4]):(?P<minute>[0-5]\d)(?::(?P<second>[0-5]\d))?(?!\d)", _time),
        (r"(?P<year>[12]\d{3}|0\d|[7-9]\d)(?:" + _TO + r"(?P<to>\d{4}))?(?=\s?年(?!级|級|代末))",
         _year),
        (r"(?P<year>[12]\d{3})" + _TO + r"(?P<to>[12]\d{3})(?!\d)", _year),
        (rf"(?P<minus>-?)(?P<number>{_N})%?(?:{_TO}(?P<to>{_N}))?\s?(?P<sign>[%‰])", _percent),
        (rf"(?P<minus>-?)(?:(?P<before>{_MONEY})\s?(?=[\d.])|(?=[\d.,]+(?:{_MAGNITUDE})?\s?"
         rf"(?:{_MONEY})))(?P<number>{_N})(?P<magnitude>{_MAGNITUDE})?"
         rf"(?(before)|\s?(?P<behind>{_MONEY}))", _money),
        (rf"(?P<minus>-?)(?P<number>{_N})(?:{_TO}(?P<to>{_N}))?\s?(?P<unit>{_UNIT}){_UNIT_END}",
         _measure),
        (r"\+?(?:86[- ]?)?1[3-9]\d(?:[- ]?\d{4}){2}(?!\d)|\+\d{7,15}|0\d{2,3}-\d{7,8}|"
         r"\d{3,4}(?:-\d{3,4})+(?!\d)", lambda found: _digit_words(found[0])),
        (r"\d+(?:\.\d+){2,}", _version),
        (r"(?:(?P<whole>\d{1,9}) )?(?P<above>\d{1,9})/(?P<below>\d{1,9})", _fraction),
        (rf"(?P<one>{_N}):(?P<other>{_N})", _ratio),
        (rf"(?P<one>{_N}){_TO}(?P<other>{_N})", _range),
        (r"\d{7,}", lambda found: [number(found[0])] if found[0].endswith("0000")
         else _digit_words(found[0])),
        (rf"-(?P<number>{_N})", lambda found: ["负", number(found["number"])]),
        (rf"2(?=\s?{_COUNTED})(?!\s?(?:{_NOT_COUNTED}))", lambda _: ["两"]),
        (_N, lambda found: [number(found[0])]),
    )
)  # fmt: skip

_CALLED: Final = re.compile(_CALL + "$")
_START: Final = re.compile(rf"[\d.+-]|{_MONEY}")
_SPOKEN_CODE: Final = re.compile(r"\d{3,6}(?![\d.,:/年月%])", re.ASCII)


def read_amount(text: str, start: int) -> tuple[list[str], int] | None:
    """The words of the amount at `start` of a line, and where it ends; None if there is none.

    `text` is in half-width digits and signs; 第 in front of a number keeps 二.
    """
    if not _START.match(text, start):
        return None
    before = text[max(0, start - 8) : start].rstrip()
    if _CALLED.search(text[max(0, start - 8) : start]) and (
        found := _SPOKEN_CODE.match(text, start)
    ):
        return _digit_words(found[0]), found.end()
    last = text[start - 1 : start]
    if text[start] in "+-" and (last == ")" or (last.isascii() and last.isalnum())):
        return None
    for pattern, rule in _RULES:
        if found := pattern.match(text, start):
            words = rule(found)
            if before.endswith("第") and words == ["两"]:
                words = ["二"]
            return words, found.end()
    return None
