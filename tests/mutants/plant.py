"""One-token changes of C: where they can be made, and the text with one of them."""
import re
from collections import namedtuple

# A change: bytes begin..end of the file's text become `new`.
Change = namedtuple("Change", "path begin end new kind")

TOKEN = re.compile(r"""
  (?P<skip>/\*.*?\*/|//[^\n]*|^[ \t]*\#(?:\\\n|[^\n])*|[ \t\n]+)
 |(?P<text>"(?:\\.|[^"\\])*"|'(?:\\.|[^'\\])*')
 |(?P<number>(?:0[xX][0-9a-fA-F]+|\d+\.?\d*(?:[eE][-+]?\d+)?|\.\d+(?:[eE][-+]?\d+)?)[uUlLfF]*)
 |(?P<name>[A-Za-z_]\w*)
 |(?P<op>->|\+\+|--|<<=|>>=|<<|>>|<=|>=|==|!=|&&|\|\||[-+*/%&|^]=|\.\.\.|[-+*/%<>=!~&|^?:;,.(){}\[\]])
""", re.X | re.S | re.M)
Token = namedtuple("Token", "kind text begin end")

SWAP = {"<": ["<="], "<=": ["<"], ">": [">="], ">=": [">"], "==": ["!="], "!=": ["=="], "&&": ["||"], "||": ["&&"], "+=": ["-="], "-=": ["+="],
        "*=": ["/="], "/=": ["*="], "/": ["*"], "%": ["/"]}
VALUE_WORDS = {"sizeof", "return", "case", "else", "do", "goto"}


def tokens(text):
    found, at = [], 0
    while at < len(text):
        m = TOKEN.match(text, at)
        if not m:
            at += 1
            continue
        if m.lastgroup != "skip":
            found.append(Token(m.lastgroup, m.group(), m.start(), m.end()))
        at = m.end()
    return found


def closing(toks, i):
    """The index of the bracket that closes the one at i."""
    depth = 0
    for k in range(i, len(toks)):
        if toks[k].text in ("(", "[", "{"):
            depth += 1
        elif toks[k].text in (")", "]", "}"):
            depth -= 1
            if depth == 0:
                return k
    return len(toks) - 1


def bodies(toks):
    """Index ranges of the bodies of functions: a brace at depth 0 behind a parenthesis."""
    i = 0
    while i < len(toks):
        if toks[i].text == "{":
            end = closing(toks, i)
            if i and toks[i - 1].text == ")":
                yield i + 1, end
            i = end
        i += 1


def tables(toks, begin, end):
    """Tokens of `static const ... = {...};`, of enums and of structs inside a body are not changed."""
    skip, i = set(), begin
    while i < end:
        if toks[i].text in ("static", "enum", "struct", "typedef"):
            k = i
            while k < end and toks[k].text != ";":
                k = closing(toks, k) if toks[k].text in ("(", "{", "[") else k
                k += 1
            skip.update(range(i, k + 1))
            i = k
        i += 1
    return skip


def ends_value(t):
    return (t.kind in ("name", "number") and t.text not in VALUE_WORDS) or t.text in (")", "]")


def is_binary(text, toks, i):
    """Whether + - * between values: the style puts a space on both sides or on none; a pointer's star has one."""
    t, before, after = toks[i], toks[i - 1], toks[i + 1]
    if not ends_value(before) or text[t.begin - 1].isspace() != text[t.end].isspace():
        return False
    return after.kind in ("name", "number", "text") or after.text in ("(", "-", "!", "&", "*", "{")


def operand_end(toks, i):
    """Index behind the name with its members that begins at i."""
    i += 1
    while toks[i].text in (".", "->") or toks[i].text in ("[", "("):
        i = closing(toks, i) + 1 if toks[i].text in ("[", "(") else i + 2
    return i


def changes_of_token(path, text, toks, i):
    t, before, after = toks[i], toks[i - 1], toks[i + 1]

    def change(begin, end, new, kind):
        return Change(path, begin, end, new, kind)

    if t.text in SWAP:
        for new in SWAP[t.text]:
            yield change(t.begin, t.end, new, "operator")
    if t.text in ("<", "<=", ">", ">=") and after.kind == "name":
        k = operand_end(toks, i + 1)
        if toks[k].text in (";", ")", "&&", "||", "?"):
            yield change(toks[k - 1].end, toks[k - 1].end, " + 1", "bound")
            yield change(toks[k - 1].end, toks[k - 1].end, " - 1", "bound")
    if t.text in ("+", "-", "*") and is_binary(text, toks, i):
        yield change(t.begin, t.end, {"+": "-", "-": "+", "*": "/"}[t.text], "operator")
    elif t.text == "-" and not ends_value(before) and after.text != "=":
        yield change(t.begin, t.end, " ", "sign")
    if t.text == "!":
        yield change(t.begin, t.end, " ", "negation")
    if t.kind == "number" and t.text in ("0", "1") and before.text not in ("-", "case"):
        yield change(t.begin, t.end, "1" if t.text == "0" else "0", "constant")
    elif t.kind == "number" and t.text.isdigit():
        yield change(t.begin, t.end, str(int(t.text) + 1), "constant")
    if t.text in ("break", "continue") and after.text == ";":
        yield change(t.begin, t.end, "", "dropped")
    if t.text == "return" and after.text != ";":
        k = i
        while toks[k].text != ";":
            k = closing(toks, k) if toks[k].text in ("(", "{", "[") else k
            k += 1
        if k > i + 2:
            yield change(after.begin, toks[k - 1].end, "0", "returned")
    if t.kind == "name" and before.text in (";", "{", "}", ")", "else") and t.text not in VALUE_WORDS:
        yield from dropped(path, toks, i)


def dropped(path, toks, i):
    """A statement that is a call or an assignment."""
    k = operand_end(toks, i)
    if toks[k].text in ("=", "+=", "-=", "*=", "/=", "|=", "&=", "++", "--") or (toks[k].text == ";" and toks[k - 1].text == ")"):
        if toks[i].text in ("if", "for", "while", "switch"):
            return
        while toks[k].text != ";":
            if toks[k].text in (")", "}"):
                return  # the step of a `for`
            k = closing(toks, k) + 1 if toks[k].text in ("(", "{", "[") else k + 1
        yield Change(path, toks[i].begin, toks[k].begin, "", "dropped")


def changes(path, text):
    toks = tokens(text)
    for begin, end in bodies(toks):
        skip = tables(toks, begin, end)
        for i in range(begin, end):
            if i not in skip and toks[i].kind != "text":
                yield from changes_of_token(path, text, toks, i)


def apply(text, c):
    return text[:c.begin] + c.new + text[c.end:]


def line_of(text, c):
    """Number of the line, and the line before and after."""
    first = text.rfind("\n", 0, c.begin) + 1
    last = text.find("\n", c.end)
    after = text[first:c.begin] + c.new + text[c.end:last]
    return text.count("\n", 0, c.begin) + 1, " ".join(text[first:last].split()), " ".join(after.split())


def function_of(text, c):
    """The name of the function that a change stands in."""
    heads = re.findall(r"^[A-Za-z][^\n=;]*?\b(\w+)\([^;{}]*\)\s*\{", text[:c.begin], re.M)
    return heads[-1] if heads else "?"
