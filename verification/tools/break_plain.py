#!/usr/bin/env python3
"""Breaks every statement of the plain engine once and expects plain_test to fail.

    break_plain.py --build BUILD [--only K] [--list]

All breaks are compiled into one program, each behind a number; the environment variable DPDREF_BROKEN names the one
that is done. A statement is left out; a condition is turned round; what a variable starts with, or a function
returns, is changed a little. Prints what is not found, and exits with 1 if there is any.
"""
import argparse
import concurrent.futures
import os
import pathlib
import re
import resource
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
SOURCE = ROOT / "src" / "plain"

SWITCH = """
#include <array>
#include <cstdlib>
#include <type_traits>
#include "state.hpp"
namespace dpd::plain {
inline int const broken_place = [] {
    char const* const place = std::getenv("DPDREF_BROKEN");
    return place ? std::atoi(place) : -1;
}();
inline bool broken(int place) { return place == broken_place; }
template <class T>
auto changed(int place, T const& x) {
    if constexpr (std::is_same_v<T, bool>) return x != broken(place);
    else if constexpr (std::is_floating_point_v<T>) return broken(place) ? x * T(1.01) + T(0.01) : x;
    else if constexpr (std::is_integral_v<T>) return T(x + T(broken(place)));
    else if constexpr (requires { x.v[0]; }) {  // random bits
        T y = x;
        y.v[0] += broken(place);
        return y;
    } else return (x + (broken(place) ? 0.01 : 0.0)).eval();
}
inline PairVirials changed(int place, PairVirials x) {
    return {changed(place, x.potential), x.thermostat, x.friction};
}
template <int d>
Pair<d> changed(int place, Pair<d> pair) {
    if (broken(place)) pair.r *= 1.01;
    return pair;
}
inline std::array<double, 2> changed(int place, std::array<double, 2> x) {
    return {changed(place, x[0]), changed(place, x[1])};
}
}
"""


def split_at_commas(text):
    """The parts between commas outside all brackets; a < counts as one only after a name of a type."""
    parts, depth, begin = [], 0, 0
    for k, c in enumerate(text):
        depth += c in "([{"
        depth -= c in ")]}"
        if c == "," and depth == 0 and text[:k].count("<") <= text[:k].count(">") + text[:k].count(" < "):
            parts.append(text[begin:k])
            begin = k + 1
    return parts + [text[begin:]]


def closing(text, begin):
    """Where the bracket that opens at `begin` closes."""
    depth = 0
    for k in range(begin, len(text)):
        depth += text[k] in "([{"
        depth -= text[k] in ")]}"
        if depth == 0:
            return k
    raise ValueError(text)


class Breaker:
    def __init__(self):
        self.places = []  # (file, line, what)
        self.left = []    # statements without a break

    def new(self, where, what):
        self.places.append((*where, what))
        return len(self.places) - 1

    def value(self, where, text, what):
        return f"changed({self.new(where, what)}, {text.strip()})"

    def statement(self, where, text):
        """A statement without its indent, broken."""
        text = text.strip()
        if m := re.match(r"(\} else )?if \(", text):
            end = closing(text, m.end() - 1)
            condition, rest = text[m.end():end], text[end + 1:].strip()
            place = self.new(where, f"turned: if ({condition})")
            head = f"{m[1] or ''}if (bool({condition}) != broken({place}))"
            return f"{head} {rest}" if rest == "{" else f"{head} {{ {self.statement(where, rest)} }}"
        if text.startswith("for ("):
            end = closing(text, 4)
            head, rest = text[:end + 1], text[end + 1:].strip()
            place = self.new(where, f"left out: {head}")
            inner = rest if rest in ("", "{") else f"{{ {self.statement(where, rest)} }}"
            return f"if (!broken({place})) {head} {inner}"
        if m := re.match(r"(auto const \w+ = \[[^\]]*\]\([^()]*\) \{ return )(.+)(; \};)$", text):  # a lambda of one line
            return f"{m[1]}{self.value(where, m[2], f'changed: {text}')}{m[3]}"
        if m := re.match(r"return (.+);$", text, re.S):
            if m[1].startswith("{") or m[1].lstrip().startswith("["):
                self.left.append((*where, text))
                return text
            return f"return {self.value(where, m[1], f'changed: {text}')};"
        if m := re.match(r"((?:static )?[\w:]+(?:<[^;=()]*>)?(?: const)?(?:\*|&)?) (\[?\w.*);$", text, re.S):
            kind, names = m[1], m[2]
            first = kind.split()[0]
            if first in ("using", "return", "extern", "template", "namespace", "struct") or "&" in kind:
                self.left.append((*where, text))
                return text
            if first not in ("continue", "delete") and re.match(r"[\w\[\], ]+(=|\{|$|,)", names):
                parts = split_at_commas(names) if not names.startswith("[") else [names]
                for k, part in enumerate(parts):
                    name, equals, value = part.partition(" = ")
                    if not equals or value.lstrip().startswith(("[", "{")) or "Zero()" in value or "NoiseKey" in kind:
                        self.left.append((*where, text))
                        continue
                    cast = f"{kind.replace(' const', '')}" if first in ("double", "int", "bool") else None
                    changed = self.value(where, f"{cast}({value.strip()})" if cast else value, f"changed: {part.strip()}")
                    parts[k] = f"{name} = {changed}"
                return f"{kind} {', '.join(parts)};"
        if text.endswith(";") and text != ";" and not re.match(r"(using|extern|template|struct|\}|namespace)", text):
            return f"if (!broken({self.new(where, f'left out: {text}')})) {{ {text} }}"
        return text

    def file(self, path):
        """The text of a file with all its breaks."""
        result, pending, first_line = [], "", 0
        for number, line in enumerate(path.read_text().splitlines(), 1):
            code = re.sub(r"\s*//.*", "", line)
            if not code.strip() or code.startswith("#"):
                result.append(code)
                continue
            if not pending:
                first_line = number
            pending = f"{pending} {code.strip()}" if pending else code.strip()
            open_round = pending.count("(") - pending.count(")")
            where = (path.name, first_line)
            lambda_begins = open_round > 0 and pending.endswith("{")
            if not lambda_begins and (open_round > 0 or pending[-1] not in ";{}:") and not (
                    re.match(r"(template|struct|public)", pending) or (
                        pending.startswith("for (") and open_round == 0) or re.match(r"(static )?[\w:<>, ]+ \w+\(.*\)$", pending)):
                continue
            if m := re.match(r"((?:static )?[\w:<>,&* ]+ \w+\([^()]*\)(?: const)? \{) (.+) \}$", pending):
                body = m[2]
                result.append(f"{m[1]} {self.statement(where, body)} }}")
            elif lambda_begins or re.match(r"(struct|namespace|template|\}|public)", pending) and not pending.startswith("} else if"):
                result.append(pending)
            elif re.match(r"(static )?[\w:<>,& ]+ \w+\(.*\)( const)?( \{)?;?$", pending) and not re.match(r"(return|else)\b", pending) and "=" not in pending.split("(")[0]:
                result.append(pending)
            else:
                result.append(self.statement(where, pending))
            pending = ""
        return "\n".join(result) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--build", required=True, help="a build directory")
    parser.add_argument("--only", type=int, help="one break")
    parser.add_argument("--list", action="store_true", help="only list the breaks")
    arguments = parser.parse_args()
    breaker = Breaker()
    target = pathlib.Path(arguments.build) / "broken_plain"
    target.mkdir(parents=True, exist_ok=True)
    for path in sorted(SOURCE.iterdir()):
        text = breaker.file(path)
        if path.suffix == ".hpp":
            text = text.replace("#pragma once", "#pragma once" + SWITCH.replace("\n\n", "\n"), 1)
        (target / path.name).write_text(text)
    if arguments.list:
        for k, place in enumerate(breaker.places):
            print(k, *place)
        for place in breaker.left:
            print("left", *place)
        return 0
    subprocess.run(["cmake", "--build", arguments.build, "--target", "broken_plain_test"], check=True)
    test = pathlib.Path(arguments.build) / "verification" / "broken_plain_test"

    def run(place):
        environment = {**os.environ, "DPDREF_BROKEN": str(place)}
        command = [test.resolve(), "--run_test=the_noise_of_both_engines_has_the_same_bits,the_fast_engine_has_the_plain_ones_bits"]
        # one that hangs is seen, too: by its processor time, so that a busy machine is not taken for a break
        limit = lambda: resource.setrlimit(resource.RLIMIT_CPU, (600, 600))
        return subprocess.run(command, env=environment, capture_output=True, preexec_fn=limit, check=False).returncode

    if run(-1) != 0:
        print("break_plain: the test fails although nothing is broken")
        return 1
    places = range(len(breaker.places)) if arguments.only is None else [arguments.only]
    unseen = 0
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for k, code in zip(places, pool.map(run, places)):
            if code == 0:
                unseen += 1
                print("not seen:", k, *breaker.places[k], flush=True)
    print(f"{len(places)} breaks, {unseen} not seen; {len(breaker.left)} declarations have nothing to break")
    return 1 if unseen else 0


if __name__ == "__main__":
    sys.exit(main())
