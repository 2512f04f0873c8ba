#!/usr/bin/env python3
"""Looks at pages of `testbed diagnose --report` in headless Chromium: on a telephone and on a desk, light and dark.

usage: tests/page/check.py PAGE.html… [--screenshots FOLDER]
       tests/page/check.py --program target/release/testbed [--screenshots FOLDER]

With --program, the pages are those of the recordings in examples/ and, where they are, of those kept beside the repository.
Without Chromium and ChromeDriver, nothing is checked, and it says so.
"""

import argparse
import base64
import json
import pathlib
import shutil
import socket
import subprocess
import sys
import tempfile
import time
import urllib.error
import urllib.request

LARGEST = 3_000_000
FLAGS = [
    "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
    "--disable-component-update", "--disable-sync", "--force-device-scale-factor=1",
]

# What a page must be, found out in the page: a list of what is wrong.
WRONG = r"""
const wrong = [];
const root = document.documentElement;
if (root.scrollWidth > innerWidth) {
  const wide = [...document.querySelectorAll("body *")].filter((e) => e.getBoundingClientRect().right > innerWidth + 1
    && !e.closest(".scroll, .plot, .hero, svg, pre"));
  wrong.push(`scrolls sideways: ${root.scrollWidth} of ${innerWidth} px: ` + wide.slice(0, 3).map((e) => e.outerHTML.slice(0, 90)).join(" | "));
}
// Names break between their parts, not between letters.
for (const cell of document.querySelectorAll("td, h1, h2, h3, h4, dt, nav a")) {
  const text = cell.textContent.trim();
  const letters = text.length && cell.getClientRects().length ? cell.getBoundingClientRect().width / parseFloat(getComputedStyle(cell).fontSize) : 99;
  if (letters < 2 && text.length > 4) wrong.push(`is ${letters.toFixed(1)} letters wide: ${text.slice(0, 40)}`);
}
for (const link of document.querySelectorAll("a[href^='#']"))
  if (!document.getElementById(link.getAttribute("href").slice(1))) wrong.push("leads nowhere: " + link.outerHTML.slice(0, 90));
const ids = [...document.querySelectorAll("[id]")].map((e) => e.id);
for (const id of new Set(ids)) if (ids.filter((other) => other === id).length > 1) wrong.push(`twice there: #${id}`);
if (!document.querySelector("nav a")) wrong.push("has no contents");
// Contrast of text with what is behind it (WCAG 2: 4.5, 3 for large text).
const part = (c) => (c /= 255) <= 0.03928 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4;
const canvas = document.createElement("canvas").getContext("2d", { willReadFrequently: true });
const rgb = (colour) => { canvas.clearRect(0, 0, 1, 1); canvas.fillStyle = colour; canvas.fillRect(0, 0, 1, 1); return [...canvas.getImageData(0, 0, 1, 1).data]; };
const light = ([r, g, b]) => 0.2126 * part(r) + 0.7152 * part(g) + 0.0722 * part(b);
const behind = (e) => { for (; e; e = e.parentElement) { const c = rgb(getComputedStyle(e).backgroundColor); if (c[3] > 250) return c; } return [255, 255, 255, 255]; };
const said = new Set();
for (const e of document.querySelectorAll("body *:not(script):not(style)")) {
  if (![...e.childNodes].some((n) => n.nodeType === 3 && n.textContent.trim()) || !e.getClientRects().length) continue;
  const style = getComputedStyle(e);
  if (style.visibility === "hidden" || e.closest(".joint, .number") || e.classList.contains("number")) continue;
  const [a, b] = [light(rgb(e instanceof SVGElement ? style.fill : style.color)), light(behind(e))].sort((x, y) => y - x);
  const size = parseFloat(style.fontSize), large = size >= 24 || (size >= 18.66 && style.fontWeight >= 700);
  const ratio = (a + 0.05) / (b + 0.05), kind = e.tagName + "." + (e.getAttribute("class") ?? "");
  if (ratio < (large ? 3 : 4.5) && !said.has(kind)) { said.add(kind); wrong.push(`contrast ${ratio.toFixed(2)}: ${kind} "${e.textContent.slice(0, 30)}"`); }
}
for (const loaded of performance.getEntriesByType("resource")) wrong.push("loads " + loaded.name);
return wrong;
"""

FOCUS = r"""
const wrong = [];
for (const e of document.querySelectorAll("a[href], button, summary")) {
  if (!e.getClientRects().length || e.closest("svg")) continue;
  e.focus({ focusVisible: true });
  const style = getComputedStyle(e);
  if (document.activeElement !== e) wrong.push("cannot be focused: " + e.outerHTML.slice(0, 80));
  else if (style.outlineStyle === "none") wrong.push("focus cannot be seen: " + e.outerHTML.slice(0, 80));
  if (e.tagName === "BUTTON" && !e.getAttribute("aria-label")) wrong.push("has no name: " + e.outerHTML.slice(0, 80));
}
return wrong;
"""

# Zooms the first figure with its first button: its axis must become shorter, and "whole" must restore it.
ZOOM = r"""
const done = arguments[arguments.length - 1];
const figure = document.querySelector(".zoomable");
if (!figure) { done([]); return; }
figure.scrollIntoView();
setTimeout(() => {
  const wrong = [];
  const image = () => figure.querySelector("canvas")?.toDataURL();
  const whole = image();
  if (!whole) { done(["the first figure cannot be zoomed"]); return; }
  const buttons = [...figure.querySelectorAll(".zoom button")];
  buttons[0].click();
  setTimeout(() => {
    if (image() === whole) wrong.push("zooming in changes nothing");
    buttons.at(-1).click();
    setTimeout(() => { if (image() !== whole) wrong.push("showing all does not restore the figure"); done(wrong); }, 200);
  }, 200);
}, 600);
"""


class Browser:
    """Chromium, spoken to through ChromeDriver."""

    def __init__(self, chromium, driver):
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            port = free.getsockname()[1]
        self.profile = tempfile.TemporaryDirectory()
        self.process = subprocess.Popen([driver, f"--port={port}"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.url = f"http://127.0.0.1:{port}"
        options = {"binary": chromium, "args": [*FLAGS, f"--user-data-dir={self.profile.name}"]}
        wanted = {"browserName": "chrome", "goog:chromeOptions": options, "goog:loggingPrefs": {"browser": "ALL"}}
        for attempt in range(50):
            try:
                session = self.ask("POST", "/session", {"capabilities": {"alwaysMatch": wanted}})
                break
            except (urllib.error.URLError, ConnectionError):
                if attempt == 49:
                    raise
                time.sleep(0.2)
        self.url += "/session/" + session["sessionId"]

    def ask(self, method, path, body=None):
        data = json.dumps(body).encode() if body is not None else None
        request = urllib.request.Request(self.url + path, data, {"Content-Type": "application/json"}, method=method)
        with urllib.request.urlopen(request, timeout=120) as answer:
            return json.load(answer)["value"]

    def command(self, name, **parameters):
        return self.ask("POST", "/goog/cdp/execute", {"cmd": name, "params": parameters})

    def run(self, script):
        return self.ask("POST", "/execute/sync", {"script": script, "args": []})

    def run_until_done(self, script):
        return self.ask("POST", "/execute/async", {"script": script, "args": []})

    def errors(self):
        entries = self.ask("POST", "/se/log", {"type": "browser"})
        return [entry["message"] for entry in entries if entry["level"] in ("SEVERE", "WARNING")]

    def close(self):
        try:
            self.ask("DELETE", "")
        finally:
            self.process.terminate()
            self.process.wait()
            self.profile.cleanup()


def check(browser, page, screenshots):
    """What is wrong with a page, one line each."""
    wrong = []
    if page.stat().st_size > LARGEST:
        wrong.append(f"{page.stat().st_size} bytes are more than {LARGEST}")
    for scripts in (True, False):
        for width in (390, 1280):
            for theme in ("light", "dark"):
                where = f"{width} px, {theme}" + ("" if scripts else ", without scripts")
                media = [{"name": "prefers-color-scheme", "value": theme}]
                browser.command("Emulation.setDeviceMetricsOverride", width=width, height=900, deviceScaleFactor=1, mobile=width < 600)
                browser.command("Emulation.setEmulatedMedia", features=media)
                browser.command("Emulation.setScriptExecutionDisabled", value=not scripts)
                browser.ask("POST", "/url", {"url": page.resolve().as_uri()})
                # What is collapsed is looked at, too; figures are drawn when they come near.
                browser.run("for (const d of document.querySelectorAll('details')) d.open = true; return 0")
                if scripts:
                    browser.run_until_done(
                        "const done = arguments[0]; let y = 0; const step = () => { scrollTo(0, y); y += 700;"
                        " if (y < document.documentElement.scrollHeight + 700) setTimeout(step, 40); else { scrollTo(0, 0); setTimeout(done, 300); } }; step();"
                    )
                found = browser.run(WRONG) + browser.run(FOCUS)
                if scripts:
                    found += browser.run_until_done(ZOOM)
                found += browser.errors()
                wrong += [f"{where}: {line}" for line in found]
                if screenshots:
                    browser.run("document.activeElement?.blur(); scrollTo(0, 0); return 0")
                    height = browser.run("return document.documentElement.scrollHeight")
                    clip = {"x": 0, "y": 0, "width": width, "height": height, "scale": 1}
                    shot = browser.command("Page.captureScreenshot", captureBeyondViewport=True, clip=clip)
                    name = f"{page.stem}-{width}-{theme}" + ("" if scripts else "-plain") + ".png"
                    (screenshots / name).write_bytes(base64.b64decode(shot["data"]))
    return wrong


ROOT = pathlib.Path(__file__).resolve().parents[2]
# Folder, training recordings, held-out recordings.
CASES = [
    ("examples/double_pendulum", ["r143339.csv.gz", "r143524.csv.gz", "r143601.csv.gz", "r144115.csv.gz"], ["r154220.csv.gz"]),
    ("examples/concealed", ["train_1.csv.gz", "train_2.csv.gz"], ["held_out.csv.gz"]),
    ("../shared/recordings/emps", ["tracking.csv"], ["tracking_with_pulses.csv"]),
    ("../shared/recordings/panda", ["first_14s.csv"], ["last_7s.csv"]),
    ("../shared/recordings/lwr4", ["run_2.csv", "run_3.csv"], ["run_1.csv"]),
    ("../shared/blind/case_000", ["train_1.csv", "train_2.csv", "train_3.csv"], ["held_out.csv"]),
]


def made(program, folder):
    """The pages that the program makes of the cases that are there."""
    for place, train, held_out in CASES:
        case = ROOT / place
        if not case.is_dir():
            print(f"skipped: {place} is not there")
            continue
        page = folder / (case.name + ".html")
        files = ["--robot", "robot.urdf", "--train", *train, "--held-out", *held_out]
        outputs = ["--report", page, "--next", folder / (case.name + ".toml")]
        subprocess.run([program, "diagnose", "--quiet", *files, *outputs], cwd=case, check=True, stdout=subprocess.DEVNULL)
        yield page


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("pages", nargs="*", type=pathlib.Path)
    parser.add_argument("--program", type=pathlib.Path)
    parser.add_argument("--screenshots", type=pathlib.Path)
    arguments = parser.parse_args()
    chromium = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
    driver = shutil.which("chromedriver")
    if not (chromium and driver):
        print("skipped: the pages are not looked at, because chromium or chromedriver is not installed")
        return 0
    if not arguments.pages and not arguments.program:
        parser.error("give pages, or --program")
    if arguments.screenshots:
        arguments.screenshots.mkdir(parents=True, exist_ok=True)
    folder = tempfile.TemporaryDirectory()
    pages = list(arguments.pages)
    if arguments.program:
        pages += made(arguments.program.resolve(), pathlib.Path(folder.name))
    browser = Browser(chromium, driver)
    count = 0
    try:
        for page in pages:
            wrong = check(browser, page, arguments.screenshots)
            count += len(wrong)
            print(f"{page}: " + (f"{len(wrong)} faults" if wrong else "as it should be"))
            for line in wrong:
                print(f"  {line}")
    finally:
        browser.close()
        folder.cleanup()
    return 1 if count else 0


if __name__ == "__main__":
    sys.exit(main())
