#!/usr/bin/env python3
"""Drives every live page of the book with a headless Chromium, from the file system: the engine runs, each slider and switch is moved by
keyboard and changes the run and its command, temperatures are read, the run stops off screen and where little motion is asked for.
The rate of frames is reported, not judged.

usage: drive.py FOLDER [--pictures DIR] [--seconds S]    FOLDER as the target `docs` makes it: BUILD/docs/html; each page runs S seconds (4)

One line per page, one per defect. Exit code 0, 1 with a defect, 2 bad usage, 77 without a browser, a book, or an engine in it.
Python's standard library only.
"""

import argparse
import base64
import pathlib
import re
import shutil
import sys
import tempfile
import time

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "tools"))
from browser import NAMES, Browser

PATIENCE = 120  # seconds, for the first number with an error
PLACE = "document.querySelector('[data-live]')"
KEY = {"ArrowRight": 39, "Space": 32}


def press(browser, key):
    for kind in ("keyDown", "keyUp"):
        browser("Input.dispatchKeyEvent", type=kind, key=" " if key == "Space" else key, code=key, windowsVirtualKeyCode=KEY[key])


def errors(browser):
    for event in browser.events:
        kind, given = event.get("method"), event.get("params", {})
        if kind == "Runtime.exceptionThrown":
            yield given["exceptionDetails"].get("exception", {}).get("description", given["exceptionDetails"]["text"])
        elif kind == "Runtime.consoleAPICalled" and given["type"] == "error":
            yield str(given["args"][0].get("value"))
        elif kind == "Log.entryAdded" and given["entry"]["level"] == "error":
            yield given["entry"]["text"]
        elif kind == "Network.requestWillBeSent" and not given["request"]["url"].startswith(("file:", "data:", "about:", "blob:")):
            yield "asks the network for " + given["request"]["url"]


def steps(browser):
    return browser.value(f"Object.values({PLACE}.live.scenes).map(scene => scene.state().step)")


def open_page(browser, file, wait=60):
    browser.events.clear()
    browser("Page.navigate", url=file.as_uri())
    browser.wait("Page.loadEventFired")
    until = time.monotonic() + wait
    while not browser.value(f"!!{PLACE}.live"):
        if time.monotonic() > until:
            return False
        time.sleep(0.2)
    return True


def drive(browser, file, seconds, pictures):
    """(what was seen, defects)"""
    defects = []
    browser("Emulation.setEmulatedMedia", features=[])
    browser("Emulation.setDeviceMetricsOverride", width=1280, height=1400, deviceScaleFactor=1, mobile=False)
    if not open_page(browser, file):
        return "", ["the engine does not start", *errors(browser)]
    browser.value(f"{PLACE}.scrollIntoView(); 0")
    before = steps(browser)
    time.sleep(seconds)
    after = steps(browser)
    if not all(b > a for a, b in zip(before, after)):
        defects.append(f"does not run: steps {before}, {after}")
    rate = browser.value(f"{PLACE}.dataset.rate")
    painted = browser.value(f"""[...{PLACE}.querySelectorAll('canvas')].map(canvas => {{
        const data = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data
        let found = 0
        for (let k = 3; k < data.length; k += 4) found += data[k] > 0
        return found }})""")
    if not painted or not all(painted):
        defects.append(f"a canvas is empty: {painted} pixels")
    # every slider and switch, by keyboard
    ids = browser.value(f"[...{PLACE}.querySelectorAll('input')].map(each => each.id)")
    for identity in ids:
        element = f"document.getElementById({identity!r})"
        old, command = browser.value(f"[{element}.type === 'checkbox' ? {element}.checked : {element}.value, {PLACE}.querySelector('.live-command').textContent]")
        browser.value(f"{element}.focus(); 0")
        for _ in range(1 if isinstance(old, bool) else 12):
            press(browser, "Space" if isinstance(old, bool) else "ArrowRight")
        time.sleep(0.5)
        new, changed, label = browser.value(f"[{element}.type === 'checkbox' ? {element}.checked : {element}.value, {PLACE}.querySelector('.live-command').textContent,"
                                            f" {element}.labels.length && {element}.labels[0].textContent]")
        if new == old or changed == command:
            defects.append(f"{identity}: by keyboard {old} became {new}; its command is {'the same' if changed == command else 'another'}")
        if not label:
            defects.append(f"{identity}: no label")
        if isinstance(old, bool):
            press(browser, "Space")
            time.sleep(0.5)
    # a fluid settles before it is measured, as long as the machine lets it
    until = time.monotonic() + PATIENCE
    temperatures = []
    while not temperatures and time.monotonic() < until:
        time.sleep(1)
        table = browser.value(f"{PLACE}.querySelector('table').innerText")
        temperatures = [line for line in table.splitlines() if re.search(r"\d ± \d", line)]
    if not temperatures:
        defects.append(f"no temperature is read: {table!r}")
    if pictures:
        views = {"desktop": (1280, 1400, False), "phone": (390, 1600, False), "dark": (1280, 1400, True)}
        for name, (width, height, dark) in views.items():
            browser("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=width < 600)
            browser.value(f"document.documentElement.classList.toggle('dark-mode', {str(dark).lower()});"
                          f"document.documentElement.classList.toggle('light-mode', {str(not dark).lower()}); window.dispatchEvent(new Event('resize'));"
                          f"new Promise(done => setTimeout(() => done(0), 1500))")
            browser.value(f"{PLACE}.scrollIntoView(); 0")
            (pictures / f"{file.stem}-{name}.png").write_bytes(base64.b64decode(browser("Page.captureScreenshot")["data"]))
        browser("Emulation.setDeviceMetricsOverride", width=1280, height=1400, deviceScaleFactor=1, mobile=False)
    # off screen nothing is computed
    browser.value(f"{PLACE}.style.marginTop = '9000px'; (document.querySelector('#doc-content') || document.scrollingElement).scrollTop = 0; scrollTo(0, 0);"
                  "new Promise(done => setTimeout(() => done(0), 500))")
    before = steps(browser)
    time.sleep(0.7)
    if steps(browser) != before:
        defects.append("runs off screen")
    # nor where little motion is asked for
    defects += errors(browser)
    browser("Emulation.setEmulatedMedia", features=[{"name": "prefers-reduced-motion", "value": "reduce"}])
    if open_page(browser, file):
        browser.value(f"{PLACE}.scrollIntoView(); 0")
        time.sleep(0.7)
        if any(steps(browser)):
            defects.append("moves although little motion is asked for")
        browser.value(f"{PLACE}.querySelector('button').click(); 0")
        time.sleep(0.7)
        if not any(steps(browser)):
            defects.append("does not run when asked to")
    defects += errors(browser)
    return f"{rate} frames a second, {max(after)} steps; {' | '.join(line.replace(chr(9), ' ') for line in temperatures[:3])}", defects


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--pictures", type=pathlib.Path)
    parser.add_argument("--seconds", type=float, default=4)
    arguments = parser.parse_args()
    program = next(filter(None, map(shutil.which, NAMES)), None)
    folder = arguments.folder.resolve()
    if not program or not (folder / "live_engine.js").is_file():
        print("live pages: skipped, " + ("no book with an engine: the target docs, with emscripten" if program else "no " + NAMES[0]), file=sys.stderr)
        return 77
    if arguments.pictures:
        arguments.pictures.mkdir(parents=True, exist_ok=True)
    pages = [file for file in sorted(folder.glob("*.html")) if "data-live=" in file.read_text(encoding="utf-8", errors="replace")]
    count = 0
    with tempfile.TemporaryDirectory() as profile:
        browser = Browser(program, profile)
        try:
            for file in pages:
                seen, defects = drive(browser, file, arguments.seconds, arguments.pictures)
                print(f"{file.name}: {seen}", flush=True)
                for defect in defects:
                    print(f"{file.name}: {defect}", flush=True)
                count += len(defects)
        finally:
            browser.close()
    print(f"{len(pages)} live pages, {count} defects")
    return 1 if count or not pages else 0


if __name__ == "__main__":
    sys.exit(main())
