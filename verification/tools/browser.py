#!/usr/bin/env python3
"""Looks at every page of the book with a headless Chromium: on a phone, on a desktop (light, dark) and on paper.

usage: browser.py FOLDER [PAGE.html...] [--pictures DIR]     FOLDER as the target `docs` makes it: BUILD/docs/html

On the front page it types into the search, too (FOUND says what must come first). A defect is a formula that is not set,
Markdown that is shown as it stands, a picture that is not shown, a request that leaves the file system, a script error,
something wider than the screen that does not scroll in itself, something wider than the paper, text too faint to read, or
navigation in print. One line each, then a summary.
--pictures writes PNGs of what was seen, and the printed page as PDF.
Exit code 0, 1 with a defect, 2 bad usage, 77 without a browser. Python's standard library only.
"""

import argparse
import base64
import html.parser
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
SECONDS = 60  # for one answer of the browser, the longest page set in full

# name, width and height in CSS pixels, medium, colour scheme. A4 less Chromium's default margins of 1 cm
VIEWS = (
    ("phone", 390, 844, "screen", "light"),
    ("desktop", 1280, 900, "screen", "light"),
    ("dark", 1280, 900, "screen", "dark"),
    ("print", 717, 1046, "print", "light"),
)

# Least ratio of luminances of text and background: WCAG 2.1, 1.4.3, for large text. Small text should have 4.5, which
# some of the theme's colours of code do not.
CONTRAST = 3

# what is typed into the search, and the address that must stand first
FOUND = (
    ("viscosity", "viscosity.html"),
    ("Fig. 3b", "gallery.html#figure-ng3b"),
    ("NG2007 eq. 12", "equations.html#eq_NG2007_12"),
    ("eq. 22", "equations.html#eq_MY1997_22"),
    ("eq. 12", "equations.html#eq_NG2007_12"),
    ("Figure 3b", "gallery.html#figure-ng3b"),
    ("ng3b", "gallery.html#figure-ng3b"),
    ("critical step", "glossary.html#word-critical-step"),
    ("thermostat", "glossary.html#word-thermostat"),
    ("Schmidt number", "glossary.html#word-schmidt-number"),
    ("random force", "glossary.html#word-noise-random-force"),
    ("self-diffusion", "glossary.html#word-diffusion-constant-self-diffusion"),
    ("diffusion constant", "glossary.html#word-diffusion-constant-self-diffusion"),
    ("Green-Kubo", "glossary.html#word-green-kubo"),
    ("Lees-Edwards", "glossary.html#word-lees-edwards-boundaries"),
    ("molecular chaos", "glossary.html#word-molecular-chaos"),
    ("MSD", "glossary.html#word-mean-square-displacement-msd"),
    ("g(r)", "glossary.html#word-g-r-radial-distribution-function"),
    ("shear rate", "glossary.html#word-shear-rate"),
    ("LAMMPS", "lammps.html"),
    ("HOOMD", "hoomd.html"),
    ("walls", "walls.html"),
    ("time step", "step.html|glossary.html#word-time-step"),
    ("speed of sound", "glossary.html#word-speed-of-sound"),
    ("coarse graining", "glossary.html#word-coarse-graining|coarse-graining.html"),
    ("memory", "memory.html|glossary.html#word-memory"),
    ("temperature", "glossary.html#word-temperature-kt"),
    ("friction", "glossary.html#word-friction-dissipative-force-gamma"),
    ("velocity autocorrelation", "glossary.html#word-velocity-autocorrelation-vacf"),
    ("Shardlow", "integrators.html"),
    ("frozen_limits", "stability"),
    ("qwertz", None),
)

SEARCH = r"""(async words => {
    const field = document.getElementById("search-field");
    field.value = words;
    await BookSearch.show();
    const first = document.querySelector("#search-results a");
    return first && first.getAttribute("href");
})"""

READY = """new Promise(done => window.MathJax ? MathJax.Hub.Register.StartupHook('End', () => done(0)) : done(0)).then(() => {
    document.querySelectorAll('details').forEach(each => { each.open = true });
    if (window.toggleLevel && document.querySelector('table.directory')) toggleLevel(9);
    return new Promise(done => setTimeout(() => done(0), 0)); })"""

FORMULAS = r"""(() => {
    const wrong = node => node && (node.type === "merror" || (node.data || []).some(n => n && n.data && wrong(n)));
    const all = window.MathJax && MathJax.Hub ? MathJax.Hub.getAllJax() : [];
    const words = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
    let raw = 0;
    while (words.nextNode())
        if (!words.currentNode.parentElement.closest("script, style, code, pre, .fragment")
            && /\\f[$[{]|\\\(|\\\[|\*\*\S|\S\*\*|\\(ref|subpage)\b|@(figure|live|eq|data|measured)\{/.test(words.currentNode.data)) raw++;
    return {
        set: [...document.querySelectorAll(".MathJax_SVG > svg")].filter(s => s.clientWidth > 0).length,
        wrong: all.filter(jax => wrong(jax.root)).map(jax => jax.originalText),
        raw: raw,
        lost: [...document.images].filter(i => !(i.complete && i.naturalWidth > 0)).map(i => i.getAttribute("src"))
            .concat([...document.querySelectorAll("object")].filter(o => !o.contentDocument && o.clientWidth < 50)
            .map(o => o.data)),
    };
})()"""

# What a view shows: parts beyond the right edge, faint text, navigation. On paper nothing scrolls.
LAYOUT = r"""(paper => {
    const scrolls = e => /auto|scroll|hidden/.test(getComputedStyle(e).overflowX);
    const shown = e => e.getClientRects().length > 0 && e.checkVisibility({visibilityProperty: true});
    const name = e => e.tagName.toLowerCase() + (typeof e.className === "string" && e.className
        ? "." + e.className.trim().split(/\s+/).join(".") : "") + " '" + e.textContent.trim().slice(0, 40) + "'";
    const page = document.querySelector("#doc-content") || document.body;
    const edge = Math.min(innerWidth, page.getBoundingClientRect().right) + 1;
    const wide = [];
    for (const e of page.querySelectorAll(".header *, .contents, .contents *")) {
        if (e.closest("svg") && e.tagName !== "svg" || !shown(e)) continue;
        let inside = false;  // does an ancestor below the page scroll?
        for (let a = e.parentElement; a && a !== page && !paper; a = a.parentElement) inside = inside || scrolls(a);
        if (!inside && e.getBoundingClientRect().right > edge) wide.push(name(e));
        if (paper && scrolls(e) && e.scrollWidth > e.clientWidth + 1) wide.push("cut: " + name(e));
    }
    const channels = text => (text.match(/[\d.]+/g) || []).map(Number);
    const back = e => {
        for (; e; e = e.parentElement) {
            const c = channels(getComputedStyle(e).backgroundColor);
            if (c.length === 3 || c[3] > 0.5) return c;
        }
        return [255, 255, 255];
    };
    const light = c => {
        const [r, g, b] = c.map(x => (x /= 255) <= 0.04045 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4);
        return 0.2126 * r + 0.7152 * g + 0.0722 * b;
    };
    const faint = {};
    const words = document.createTreeWalker(page, NodeFilter.SHOW_TEXT);
    while (words.nextNode()) {
        const e = words.currentNode.parentElement;
        if (!words.currentNode.data.trim() || e.closest("script, style, .MathJax_SVG_Preview") || !shown(e)) continue;
        const [a, b] = [light(channels(getComputedStyle(e).color)), light(back(e))].sort((x, y) => y - x);
        const ratio = (a + 0.05) / (b + 0.05);
        if (ratio < LEAST) faint[e.tagName.toLowerCase() + "." + e.className] = ratio.toFixed(1) + " " + name(e);
    }
    return {
        across: Math.max(document.documentElement.scrollWidth - innerWidth, page.scrollWidth - page.clientWidth),
        screen: innerWidth,
        wide: wide,
        faint: Object.values(faint),
        navigation: paper ? ["#top", "#side-nav", "#nav-path"].filter(s => {
            const e = document.querySelector(s);
            return e && shown(e);
        }) : [],
    };
})""".replace("LEAST", str(CONTRAST))


class Formulas(html.parser.HTMLParser):
    """How many formulas a page asks for: \\( and \\[ in its text, code apart."""

    def __init__(self, text):
        super().__init__()
        self.count, self.skip = 0, 0
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        self.skip += tag in ("script", "style", "code", "pre")

    def handle_endtag(self, tag):
        self.skip -= tag in ("script", "style", "code", "pre")

    def handle_data(self, data):
        if not self.skip:
            self.count += data.count("\\(") + data.count("\\[")


class Browser:
    """One tab of a headless Chromium, by the DevTools protocol over a pipe."""

    def __init__(self, program, profile):
        ask, answer = os.pipe(), os.pipe()
        # out of the way of 3 and 4, where Chromium expects them
        reader, writer = (os.dup2(fd, at) for fd, at in ((ask[0], 20), (answer[1], 21)))

        def at_3_and_4():
            os.dup2(reader, 3)
            os.dup2(writer, 4)

        command = [program, "--headless=new", "--remote-debugging-pipe", "--disable-gpu", "--hide-scrollbars",
                   "--no-first-run", "--no-default-browser-check", "--disable-background-networking",
                   "--disable-component-update", "--host-resolver-rules=MAP * ~NOTFOUND",
                   f"--user-data-dir={profile}", "about:blank"]
        if os.geteuid() == 0:
            command.insert(1, "--no-sandbox")  # Chromium's condition for running as root
        self.process = subprocess.Popen(command, preexec_fn=at_3_and_4, pass_fds=(3, 4), stdin=subprocess.DEVNULL,
                                        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        for fd in (ask[0], answer[1], reader, writer):
            os.close(fd)
        self.to, self.frm = ask[1], answer[0]
        os.set_blocking(self.frm, False)
        self.buffer, self.number, self.session, self.events = b"", 0, None, []
        target = self("Target.createTarget", url="about:blank")["targetId"]
        self.session = self("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Network", "Log"):
            self(f"{domain}.enable")

    def message(self, until):
        while b"\0" not in self.buffer:
            if time.monotonic() > until or self.process.poll() is not None:
                raise TimeoutError("the browser does not answer")
            try:
                self.buffer += os.read(self.frm, 1 << 20)
            except BlockingIOError:
                time.sleep(0.002)
        text, self.buffer = self.buffer.split(b"\0", 1)
        return json.loads(text)

    def __call__(self, method, **parameters):
        self.number += 1
        request = {"id": self.number, "method": method, "params": parameters}
        if self.session:
            request["sessionId"] = self.session
        os.write(self.to, json.dumps(request).encode() + b"\0")
        until = time.monotonic() + SECONDS
        while True:
            message = self.message(until)
            if message.get("id") == self.number:
                if "error" in message:
                    raise RuntimeError(f"{method}: {message['error']['message']}")
                return message["result"]
            self.events.append(message)

    def wait(self, event):
        until = time.monotonic() + SECONDS
        while not any(e.get("method") == event for e in self.events):
            self.events.append(self.message(until))

    def value(self, script):
        result = self("Runtime.evaluate", expression=script, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in result:
            raise RuntimeError(result["exceptionDetails"]["exception"]["description"])
        return result["result"]["value"]

    def show(self, width, height, medium, scheme):
        self("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=width < 600)
        self("Emulation.setEmulatedMedia", media=medium,
             features=[{"name": "prefers-color-scheme", "value": scheme}])
        # the theme asks for the scheme when the page is loaded, and Doxygen lays out when the window changes
        self.value(f"document.documentElement.classList.toggle('dark-mode', {json.dumps(scheme == 'dark')});"
                   f"document.documentElement.classList.toggle('light-mode', {json.dumps(scheme == 'light')});"
                   "new Promise(done => setTimeout(() => requestAnimationFrame(() => done(0)), 50))")

    def close(self):
        try:
            self.session = None
            self("Browser.close")
        except (OSError, TimeoutError, RuntimeError):
            pass
        try:
            self.process.wait(10)
        except subprocess.TimeoutExpired:
            self.process.kill()


def search(browser):
    """defects of the search, on the page that is open"""
    for words, wanted in FOUND:
        first = browser.value(f"{SEARCH}({json.dumps(words)})")
        if not any((first or "").startswith(page) and bool(first) == bool(page) for page in (wanted or "").split("|")):
            yield f"search: '{words}' finds {first} first, not {wanted}"


def look(browser, file, pictures):
    """(formulas, defects) of a page"""
    browser.events.clear()
    browser("Page.navigate", url=file.as_uri())
    browser.wait("Page.loadEventFired")
    browser.value(READY)
    defects = []
    urls = {}
    for event in browser.events:
        if event["method"] == "Network.requestWillBeSent":
            url = urls[event["params"]["requestId"]] = event["params"]["request"]["url"]
            if not url.startswith(("file:", "data:", "about:", "blob:")):
                defects.append(f"asks the network for {url}")
        elif event["method"] == "Network.loadingFailed" and event["params"]["requestId"] in urls:
            # what the page before still waited for is cancelled, and is none of this one's
            defects.append(f"not loaded: {urls[event['params']['requestId']]} ({event['params']['errorText']})")
        elif event["method"] == "Runtime.exceptionThrown":
            details = event["params"]["exceptionDetails"]
            defects.append(f"script error: {details.get('exception', details).get('description', details['text'])}")
    seen = browser.value(FORMULAS)
    formulas = 0 if file.name.endswith("_source.html") else Formulas(file.read_text(encoding="utf-8")).count  # a source may search for brackets
    if seen["set"] != formulas:
        defects.append(f"{seen['set']} of {formulas} formulas set")
    if seen["raw"]:
        defects.append(f"{seen['raw']} places shown as TeX, Markdown or a command of Doxygen")
    defects += [f"formula with an error: {text}" for text in seen["wrong"]]
    defects += [f"picture not shown: {source}" for source in seen["lost"]]
    if file.name == "index.html":
        defects += search(browser)
    for name, width, height, medium, scheme in VIEWS:
        browser.show(width, height, medium, scheme)
        layout = browser.value(f"{LAYOUT}({json.dumps(medium == 'print')})")
        if layout["across"] > 1 or layout["screen"] > width:
            defects.append(f"{name}: the page is {max(layout['across'], layout['screen'] - width)} px too wide")
        defects += [f"{name}: too wide: {part}" for part in layout["wide"][:5]]
        defects += [f"{name}: faint text, contrast {part}" for part in layout["faint"][:5]]
        defects += [f"{name}: {part} is shown" for part in layout["navigation"]]
        if pictures:
            picture = pictures / f"{file.stem}-{name}"
            if medium == "print":
                data = browser("Page.printToPDF", paperWidth=8.27, paperHeight=11.69, preferCSSPageSize=True)["data"]
                picture.with_suffix(".pdf").write_bytes(base64.b64decode(data))
            else:
                data = browser("Page.captureScreenshot")["data"]
                picture.with_suffix(".png").write_bytes(base64.b64decode(data))
    return formulas, defects


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("pages", nargs="*")
    parser.add_argument("--pictures", type=pathlib.Path)
    arguments = parser.parse_args()
    folder = arguments.folder.resolve()
    files = [folder / page for page in arguments.pages] or sorted(folder.glob("*.html"))
    if not files or not all(file.is_file() for file in files):
        print(f"browser: no such pages in {folder}; cmake --build BUILD --target docs makes them", file=sys.stderr)
        return 2
    program = next(filter(None, map(shutil.which, NAMES)), None)
    if not program:
        print("browser: skipped, no " + ", ".join(NAMES) + " on the PATH", file=sys.stderr)
        return 77
    if arguments.pictures:
        arguments.pictures.mkdir(parents=True, exist_ok=True)
    formulas, defects = 0, 0
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        browser = Browser(program, profile)
        try:
            for file in files:
                count, found = look(browser, file, arguments.pictures)
                formulas += count
                defects += len(found)
                for defect in found:
                    print(f"{file.name}: {defect}", flush=True)
        finally:
            browser.close()
    print(f"{len(files)} pages, {formulas} formulas, {len(VIEWS)} views: {defects} defects")
    return 1 if defects else 0


if __name__ == "__main__":
    sys.exit(main())
