#!/usr/bin/env python3
"""Runs every command of README.md and of the book, docs/*.md and theory/*.md, in a copy of what a clone holds.

A command is: a line of a fenced sh block; of an indented block that begins with one; an inline span that begins with
`dpdref `, `ctest `, `cmake `, `python3 verification/` or `sh verification/`. The book's generated pages count, too. A
command must end with exit code 0 and print something, within a limit of CPU time; the pages' commands run one after
the other, as on the page, and what README.md exports is there for all of them. What they leave behind must be ignored by
git, where there is git. RULES lists those that are not run as
they stand, what runs in their place, and why. Blocks of docs/*.md whose first line is "# file: figure.toml" or
"# file: plot.gp" become the figure that the page's `dpdref figure ID` draws. A fenced block "output" holds lines that the
command before it prints.

usage: commands.py --build BUILD         all of this; BUILD holds the built program
       commands.py --build BUILD --tutorial   docs/adding_a_stage.md: its pieces of code, put where it says into a copy
                                         of the source, make a program that runs its commands; without one of them
                                         the compiler complains
       commands.py --list                the commands, and what runs in their place

One line per command; exit code 1 if one fails. Python's standard library only.
"""

import argparse
import json
import os
import pathlib
import re
import resource
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
CLONE = (".gitignore", "CMakeLists.txt", "CMakePresets.json", "CITATION.cff", "LICENSE", "README.md", "dpdrefConfig.cmake.in",
         "docs", "figures", "src", "theory", "verification")
BUILT = ("dpdref", "libdpdref_engine.a", "libdpdref_theory.a")
BEGINS = re.compile(r"(dpdref|ctest|cmake)\s|(python3|sh) verification/")
CPU_LIMIT = 60  # seconds per process; no command that runs as it stands needs more than about half of it, with both cores busy
WALL_LIMIT = 4 * 3600  # seconds: ends what sleeps for ever, and nothing that waits for a busy machine

# (pattern of a whole command, what runs in its place, why). The first that matches counts; \1 is the pattern's group.
LONG = "takes minutes"
NAMED = "names a subcommand or a closed form, is no whole command"
RULES = [
    # long: `sh verification/fresh.sh` alone prints its usage, which must have the word
    (r"sh verification/fresh\.sh (\w+)", r"sh verification/fresh.sh 2>&1 | grep -w '\1'",
     "installs packages and builds everything"),
    (r"sh verification/tools/machine\.sh (\w+).*", r"sh verification/tools/machine.sh 2>&1 | grep -w '\1'",
     "installs packages and builds everything"),
    (r"cmake --preset \w+ --toolchain (\S+) -DDPDREF_SYSROOT=FOLDER", r"ls \1",
     "needs a cross compiler; the file must exist"),
    # Definitions are read before the cache is made, here below a file, which fails: no run begins.
    (r"(dpdref (?:figure|stability|work-precision) .*--redraw.*)", r"\1 --help", "judges all figures again; cli_test redraws"),
    (r"(dpdref report)", r"\1 || [ $? -eq 1 ]", "exit code 1 where a comparison disagrees, which is a result"),
    (r"(dpdref (?:figure (?!ID)|stability|work-precision|answers).*)", r"\1 --cache LICENSE/x 2>&1 | grep 'LICENSE/x'",
     f"{LONG}; reads the definitions only (figure_test runs small ones)"),
    (r"(dpdref run .* --set time\.duration=5000)", r"\1 --set time.duration=5 --set time.equilibration=1",
     f"{LONG}; shortened"),
    (r"(dpdref run .* --set time\.duration=20000 .*)", r"\1 --set time.duration=50", f"{LONG}; shortened"),
    (r"(dpdref run .* --set time\.equilibration=500)", r"\1 --set time.equilibration=1 --set time.duration=5",
     f"{LONG}; shortened"),
    (r"(dpdref run damping\.toml).*", r"\1 2>&1 | grep damping",
     "a stage of the tutorial, which the test `tutorial` adds"),
    (r"(dpdref run channel\.toml)", r"\1 --set time.equilibration=1 --set time.duration=1", f"{LONG}; shortened"),
    # building: this test runs in a build. The copy is configured; its build is that of BUILD.
    (r"(cmake --preset \w+) -DDPDREF_BENCHMARKS=ON",
     r"\1 && grep 'DPDREF_BENCHMARKS:BOOL' build/release/CMakeCache.txt",
     "needs Google Benchmark; the option must exist"),
    (r"(cmake --build --preset \w+)", r"\1 --target help", f"{LONG}; lists the targets"),
    (r"(cmake --build build/release) --target docs", r"\1 --target help | grep -w docs",
     f"{LONG}; the target must exist"),
    (r"(python3 verification/tools/cost\.py \S+ --scaling)", r"\1 --only 'density 10' --repetitions 1",
     f"{LONG}; its shortest scene"),
    (r"(python3 verification/tools/race\.py) .*", r"\1 --help", f"{LONG}, and needs LAMMPS"),
    (r"(python3 verification/calibration/calibrate\.py) .*", r"\1 --help", LONG),
    (r"(python3 verification/symptoms/symptoms\.py) .*", r"\1 --help", f"{LONG}, and two rows of it a test, symptoms"),
    (r"(python3 verification/bits/bits\.py) .*", r"\1 --help", "a test of its own, bits; needs qemu-user with --under"),
    (r"(python3 verification/orders/orders\.py) .*", r"\1 --help", LONG),
    (r"(python3 verification/tools/record\.py) .*", r"\1 --help", f"{LONG}, and needs the benchmark"),
    (r"(python3 verification/tools/cost\.py \S+)", r"\1 --only free --repetitions 1", f"{LONG}; its cheapest scenes"),
    (r"(python3 verification/lammps/prove\.py) .*", r"\1 --help", f"{LONG}, and needs LAMMPS"),
    (r"(python3 verification/trials/\w+\.py \S+) .*", r"\1 --cases 1", f"{LONG}; a single case (other tests try more)"),
    (r"(ctest --preset \w+)", r"\1 -N | grep 'Total Tests: [1-9]'", f"{LONG}; lists the tests"),
    (r"(ctest -R \S+)", r"\1 -N --test-dir build/release | grep 'Total Tests: [1-9]'",
     "that test runs beside this one; it must exist"),
    (r"build/release/dpdref_benchmark", r"grep 'add_executable(dpdref_benchmark' CMakeLists.txt",
     f"{LONG}, and needs Google Benchmark; must be a target"),
    (r"(cmake --install build/release --prefix) /usr/local", r"\1 build/prefix && build/prefix/bin/dpdref --version",
     "into the copy"),
    (r"\(cd (\w+); lmp -in (\S+)\)", r"ls \1/\2", "needs LAMMPS; its input must be there"),
    # placeholders, and names
    (r"dpdref figure ID\.\.\. \| all \[--budget quick\|paper\] \[--jobs N\]",
     "dpdref figure my1 --budget paper --jobs 1 --cache LICENSE/x 2>&1 | grep 'LICENSE/x'", "syntax"),
    (r"dpdref theory ID key=value \.\.\.", "dpdref theory ng10 n=3 gamma=9", "syntax"),
    (r"(dpdref theory) ([\w-]+)", r"\1 | grep '^\2 '", NAMED),
    (r"(dpdref tune) eta=.* Sc=.*", r"\1 eta=1.5 n=3 2>&1 | grep allowed", f"{LONG}; reads the arguments only"),
    (r"(dpdref (?:run|figure|compare|export lammps|tune))", r"\1 --help", NAMED),
    (r"(dpdref compare) \S+ (--answer (\S+))(?: --as .*)?",
     r"(echo quantity,value,error,blocks; grep '^\3,' figures/answers/answers.csv | cut -d, -f2-5) > build/own.csv && "
     r"\1 build/own.csv \2",
     "needs another code's output; the answer's own numbers must agree"),
    (r"(dpdref answer .* --measure)", r"\1 N=100 --within 5%", f"{LONG}; a small box and a large error"),
    (r"(dpdref compare) \S+ (--of .* --measure)",
     r"(echo quantity,value,error; echo kinetic_temperature,2.0,1.0) > build/own.csv && \1 build/own.csv \2 N=100 --within 5%",
     f"{LONG}, and needs another code's output; a small box and a large error"),
    (r"dpdref run SCENE\.toml", "dpdref run verification/scenes/ideal_gas_rest.toml", "syntax"),
    (r"dpdref run SCENE( --engine plain)", r"dpdref run verification/scenes/ideal_gas_rest.toml\1 "
     "--set box.length=[5,5,5] --set time.duration=200", "syntax"),
    (r"dpdref run --json", "dpdref run verification/scenes/ideal_gas_shear.toml --json --set time.duration=5 "
     "--set time.equilibration=0", "syntax"),
]


# --- what the pages say


def parts_of(line):
    """a && b as [a, b]; without a comment"""
    return [part.strip() for part in re.sub(r"\s+# .*$", "", line).split("&&")]


def joined(lines):
    """Lines that end with a backslash with the next one"""
    return re.sub(r"\\\n\s*", "", "\n".join(lines)).splitlines()


def blocks_of(text):
    """(kind, lines) of a page, in order: kind is sh or another language, indented, text"""
    kind, lines = "text", []
    for line in text.splitlines():
        fence = re.match(r"```\s*(\w*)", line)
        if kind.startswith("fence "):
            if fence:
                yield kind.removeprefix("fence "), lines
                kind, lines = "text", []
            else:
                lines.append(line)
        elif fence:
            yield kind, lines
            kind, lines = "fence " + fence[1], []
        elif kind == "text" and line.startswith("    ") and not (lines and lines[-1].strip()):
            yield kind, lines
            kind, lines = "indented", [line[4:]]
        elif kind == "indented" and line.strip() and not line.startswith("    "):
            yield kind, lines
            kind, lines = "text", [line]
        else:
            lines.append(line[4:] if kind == "indented" else line)
    yield kind, lines


def commands_of(text):
    for kind, lines in blocks_of(text):
        if kind == "sh" or (kind == "indented" and BEGINS.match(lines[0])):
            for line in joined(lines):
                if line.strip() and not line.startswith("#"):
                    yield from parts_of(line)
        elif kind == "text":
            for span in re.findall(r"(?<!`)`([^`]+)`(?!`)", "\n".join(lines)):
                if BEGINS.match(span):
                    yield " ".join(span.split())


def outputs_of(text):
    """command -> lines of the block "output" right behind it"""
    shown, last = {}, None
    for kind, lines in blocks_of(text):
        if kind == "output":
            shown[last] = lines
        elif kind == "sh":
            last = parts_of(joined(lines)[-1])[-1]
    return shown


def scene_beside(file, text):
    """The page's next block, after it names the file, that holds a scene"""
    after = text[text.index(file):].partition("\n")[2]
    return next(("\n".join(lines) for kind, lines in blocks_of(after)
                 if kind not in ("text", "sh") and any(line.startswith("stages =") for line in lines)), None)


def files_of_figure(text):
    """NAME -> contents of the blocks that begin with '# file: NAME'"""
    return {lines[0].removeprefix("# file:").strip(): "\n".join(lines) + "\n"
            for kind, lines in blocks_of(text) if kind != "text" and lines and lines[0].startswith("# file:")}


def in_place_of(command, own_figures):
    """(what runs, reason or None)"""
    figure = re.match(r"dpdref figure ([\w-]+)", command)
    if figure and figure[1] in own_figures and "paper" not in command:
        return command, None
    for pattern, instead, reason in RULES:
        match = re.fullmatch(pattern, command)
        if match:
            return match.expand(instead), reason
    return command, None


def pages(root):
    return [root / "README.md", *sorted((root / "docs").glob("*.md")), *sorted((root / "theory").glob("*.md"))]


def collect(root, generated=()):
    """[(page, command)] without repetition, scenes {file: text}, figures {id: {file: text}}, outputs {command: lines}"""
    found, scenes, figures, outputs = {}, {}, {}, {}
    for page in [*pages(root), *generated]:
        text = page.read_text(encoding="utf-8")
        commands = list(commands_of(text))
        outputs |= outputs_of(text)
        for command in commands:
            found.setdefault(command, page.name if page in generated else str(page.relative_to(root)))
            file = re.match(r"dpdref run (\S+\.toml)", command)
            if file and not (root / file[1]).exists():
                scene = scene_beside(file[1], text)
                if scene:
                    scenes[file[1]] = scene
        files = files_of_figure(text)
        if files:
            ids = [m[1] for c in commands if (m := re.match(r"dpdref figure ([\w-]+)", c))
                   and not (root / "verification" / m[1]).exists()]
            figures[ids[0] if ids else page.stem] = files
            if not ids:
                found.setdefault(f"dpdref figure {page.stem} --budget quick", str(page.relative_to(root)))
    return [(found[command], command) for command in found], scenes, figures, outputs


# --- running

environment = dict(os.environ)  # and what the pages' commands export


def export(name, value, root):
    """As the shell would: with its quotes and variables"""
    environment[name] = subprocess.run(["sh", "-c", f"printf %s {value}"], cwd=root, env=environment,
                                       stdout=subprocess.PIPE, text=True, check=True).stdout


def run(command, root, cpu_limit=CPU_LIMIT):
    """(None or what went wrong, output)"""
    def limited():
        resource.setrlimit(resource.RLIMIT_CPU, (cpu_limit, cpu_limit))

    try:
        result = subprocess.run(["sh", "-c", command], cwd=root, env=environment, stdin=subprocess.DEVNULL,
                                stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=WALL_LIMIT,
                                preexec_fn=limited, check=False)
    except subprocess.TimeoutExpired:
        return f"no end after {WALL_LIMIT} s", ""
    if result.returncode in (-9, -24, 137, 152):
        return f"more than {cpu_limit} s of CPU time: give it a rule in verification/tools/commands.py", result.stdout
    if result.returncode != 0:
        return f"exit code {result.returncode}", result.stdout
    return (None if result.stdout.strip() else "prints nothing"), result.stdout


def show(ran, command, page, wrong=None, output=""):
    print(f"{'FAILED' if wrong else ran}  {page}: {command}" + (f"  [{wrong}]" if wrong else ""), flush=True)
    if wrong:
        print("    " + "\n    ".join(output.splitlines()[-15:]), flush=True)


def clone(build, root):
    for name in CLONE:
        source = ROOT / name
        if source.is_dir():
            shutil.copytree(source, root / name, ignore=shutil.ignore_patterns("__pycache__", "quick"))
        elif source.exists():
            shutil.copy(source, root / name)
    (root / "build" / "release").mkdir(parents=True)
    for name in BUILT:
        shutil.copy2(build / name, root / "build" / "release" / name)
    wrong, output = run("cmake --preset release", root)  # then `cmake --install` and `ctest -N` find what they need
    if wrong:
        sys.exit(f"the copy cannot be configured: {wrong}\n{output}")
    return output


def generated_pages(root):
    """The book's pages that scripts write, as docs/docs.cmake does"""
    made = root / "made"
    made.mkdir()
    for script in (["verification/tools/equations.py", "--write", "made"], ["docs/gallery.py", "made"],
                   ["verification/tools/claims.py", "--out", "made/claims.md"]):
        # whether they find mistakes is for the tests equations and claims
        subprocess.run([sys.executable, "-B", *script], cwd=root, stdout=subprocess.DEVNULL,
                       stderr=subprocess.DEVNULL, check=False)
    return sorted(made.glob("*.md"))


def tracked(root):
    """Makes the copy a repository that has all of its files, where there is git"""
    if shutil.which("git"):
        subprocess.run("git init -q && git add -A", shell=True, cwd=root, check=True)
    else:
        print("no git here: what the commands leave behind is not looked at")


def left_behind(root):
    """Files that git would take for new ones"""
    if not shutil.which("git"):
        return []
    return subprocess.run(["git", "ls-files", "--others", "--exclude-standard", "--directory"], cwd=root,
                          stdout=subprocess.PIPE, text=True, check=True).stdout.split()


def all_commands(root, configured):
    commands, scenes, figures, outputs = collect(root, generated_pages(root))
    for file, text in scenes.items():
        (root / file).write_text(text + "\n", encoding="utf-8")
    for name, files in figures.items():
        (root / "verification" / name).mkdir()
        for file, text in files.items():
            (root / "verification" / name / file).write_text(text, encoding="utf-8")
    counts = {"ok": 0, "rule": 0, "failed": 0}
    tracked(root)
    for page, command in commands:
        if variable := re.fullmatch(r"export (\w+)=(\S.*)", command):
            export(*variable.groups(), root)
            counts["ok"] += 1
            continue
        instead, reason = in_place_of(command, figures)
        wrong, output = run(instead, root)
        if wrong and "--target docs" in command and "No target docs" in configured:
            wrong, reason = None, "no Doxygen here, so no target docs"
        if missing := set(outputs.get(command, ())) - set(output.splitlines()):
            wrong = wrong or f"does not print {min(missing)!r}"
        counts["failed" if wrong else "rule" if reason else "ok"] += 1
        show(f"rule ({reason})" if reason else "ok", command, page, wrong, output)
    for file in left_behind(root):
        counts["failed"] += 1
        print(f"FAILED  {file} is left behind, and not ignored by git")
    print(f"{len(commands)} commands: {counts['ok']} ran as they stand, {counts['rule']} by a rule, "
          f"{counts['failed']} failed; {resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime:.0f} s of CPU time")
    return counts["failed"]


# --- the tutorial: docs/adding_a_stage.md

TUTORIAL = pathlib.Path("docs", "adding_a_stage.md")
PIECE = re.compile(r"^In `(\S+)`, (before|after) `([^`]+)`:\n\n```cpp\n(.*?)```$", re.M | re.S)
MOST_PIECES, MOST_FILES = 5, 4


def pieces_of(page):
    """(file, before or after, text that stands there, code) of the page's pieces"""
    pieces = PIECE.findall(page)
    files = {file for file, *_ in pieces}
    if not pieces or len(pieces) > MOST_PIECES or len(files) > MOST_FILES:
        sys.exit(f"{TUTORIAL}: {len(pieces)} pieces of code in {len(files)} files; allowed: at most {MOST_PIECES} in {MOST_FILES}")
    return pieces


def put(root, pieces):
    for file, side, anchor, code in pieces:
        text = (root / file).read_text(encoding="utf-8")
        at = text.find(anchor)
        if at < 0:
            sys.exit(f"{TUTORIAL}: {file} has no '{anchor}'")
        at = text.rfind("\n", 0, at) + 1 if side == "before" else at + len(anchor)
        # a piece within a line ends where the line goes on
        code = code.rstrip("\n") if side == "after" else code
        (root / file).write_text(text[:at] + code + text[at:], encoding="utf-8")


def does_not_compile(root, file, build):
    """Whether the compiler rejects the file, with the flags of the build"""
    flags = next(entry["command"] for entry in json.loads((root / build / "compile_commands.json").read_text())
                 if entry["file"].endswith(file))
    command = re.sub(r" -o \S+| -MF \S+| -MT \S+| -MD", "", flags).replace(" -c ", " -fsyntax-only ")
    return subprocess.run(command, shell=True, cwd=root / build, capture_output=True, check=False).returncode != 0


def forgotten_parts(root, pieces):
    """What the compiler must notice: a part of the struct, or the action in either engine, left out"""
    struct = pieces[0]
    parts = [line for line in struct[3].splitlines() if re.match(r"    (static constexpr|void|double) .*(kind\{|\()", line)]
    for part in parts:
        lines = struct[3].splitlines(keepends=True)
        first = next(k for k, line in enumerate(lines) if line.startswith(part))
        last = next(k for k in range(first, len(lines)) if lines[k].rstrip().endswith(("};", "}")) or "}  //" in lines[k])
        without = "".join(lines[:first] + lines[last + 1:])
        name = part.split("(")[0].split("{")[0].split()[-1]
        asks = "src/figures/theory_arguments.cpp" if name == "set_arguments" else "src/scene/scene.cpp"
        yield name, [(*struct[:3], without), *pieces[1:]], asks
    for k, (file, *_) in enumerate(pieces):
        if file.endswith("stages.cpp"):
            yield "the action of the engine", pieces[:k] + pieces[k + 1:], file
        if "/plain/" in file:
            yield "the action of the plain engine", pieces[:k] + pieces[k + 1:], "src/run/plain_stages.cpp"


def has_sanitizers(root):
    """Whether the compiler has the libraries of the checks, which clang's package does not bring everywhere"""
    program = root / "empty.cpp"
    program.write_text("int main() {}\n", encoding="utf-8")
    command = [os.environ.get("CXX", "c++"), "-fsanitize=address,undefined", program, "-o", root / "empty"]
    return subprocess.run(command, capture_output=True, check=False).returncode == 0


def tutorial(root, build):
    page = (root / TUTORIAL).read_text(encoding="utf-8")
    pieces = pieces_of(page)
    originals = {file: (root / file).read_text(encoding="utf-8") for file, *_ in pieces}
    # with the checks of the preset sanitize: the commands below and some damaged inputs run through them
    sanitizers = "ON" if has_sanitizers(root) else "OFF"
    configure = ("cmake -G Ninja -S . -B taught -DDPDREF_TESTS=OFF -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS=-O0 "
                 f"-DCMAKE_CXX_FLAGS_DEBUG= -DCMAKE_EXPORT_COMPILE_COMMANDS=ON -DDPDREF_SANITIZE={sanitizers}")
    failures = 0

    def check(command):
        nonlocal failures
        wrong, output = run(command, root, cpu_limit=10 * CPU_LIMIT)  # compiles
        show("ok", command, TUTORIAL, wrong, output)
        failures += bool(wrong)
        return not wrong

    if not check(configure):
        return failures
    for part, without, file in forgotten_parts(root, pieces):
        put(root, without)
        rejected = does_not_compile(root, file, "taught")
        show("ok", f"without {part} {file} does not compile", TUTORIAL, None if rejected else "it compiles", "")
        failures += not rejected
        for changed, text in originals.items():
            (root / changed).write_text(text, encoding="utf-8")
    put(root, pieces)
    if not check("cmake --build taught --target dpdref"):
        return failures
    (root / "damping.toml").write_text(scene_beside("damping.toml", page) + "\n", encoding="utf-8")
    for _, command in ((kind, line) for kind, lines in blocks_of(page) if kind == "indented" for line in lines):
        if command.startswith("dpdref run damping.toml"):
            check("taught/" + command)
    # the formula of the page, and one result for both engines
    check("""taught/dpdref run damping.toml --json >damped && taught/dpdref run damping.toml --engine plain --json >plainly \\
        && taught/dpdref run damping.toml --set damping.rate=0 --json >free && python3 -c '
import json, math
kT = [json.load(open(f))["quantities"]["kinetic_temperature"]["value"] for f in ("damped", "free", "plainly")]
assert kT[0] == kT[2] and abs(kT[0] / kT[1] - math.exp(-0.1)) < 1e-12, kT
print("kT", *kT)'""")
    if sanitizers == "ON":
        check("python3 -B verification/trials/fuzz.py taught/dpdref --seconds 20")
    return failures


def main(arguments):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", metavar="BUILD", type=pathlib.Path, help="folder of the built program")
    parser.add_argument("--tutorial", action="store_true", help="the tutorial in place of the commands")
    parser.add_argument("--list", action="store_true", help="list the commands of README.md, docs/ and theory/")
    options = parser.parse_args(arguments)
    if options.list:
        commands, _, figures, _ = collect(ROOT)
        for page, command in commands:
            instead, reason = in_place_of(command, figures)
            print(f"{page}: {command}" + (f"\n    runs: {instead}\n    why: {reason}" if reason else ""))
        return 0
    if not options.build:
        parser.error("--build BUILD")
    with tempfile.TemporaryDirectory() as scratch:
        root = pathlib.Path(scratch).resolve()
        build = options.build.resolve()
        configured = clone(build, root)
        return 1 if (tutorial(root, build) if options.tutorial else all_commands(root, configured)) else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
