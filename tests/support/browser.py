"""Headless Chromium driven over its debugging pipe: pages opened, run, photographed; what they complain of.

with Browser() as browser:
    page = browser.open(file, width=1000, height=700)
    page.run("document.title")
    page.picture()            # numpy array, rows x columns x 3
    page.complaints           # console errors, exceptions
    page.requests             # addresses it asked for besides its own file
"""

from __future__ import annotations

import base64
import io
import json
import os
import select
import shutil
import subprocess
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from support.programs import PATIENCE

OPTIONS = (
    "--headless=new", "--remote-debugging-pipe", "--no-first-run", "--disable-background-networking",
    "--disable-component-update", "--disable-sync", "--disable-quic", "--disable-extensions",
    "--hide-scrollbars", "--force-device-scale-factor=1",
    # WebGL by the processor: the machines of the tests have no graphics card
    "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
    "--disable-gpu-compositing",  # putting pages together by that as well would take longer than drawing
)  # fmt: skip


def chromium() -> str:
    """scripts/setup.sh installs it"""
    for name in ("chromium", "chromium-browser", "google-chrome"):
        if found := shutil.which(name):
            return found
    raise FileNotFoundError("no Chromium: run scripts/setup.sh")


class Browser:
    def __enter__(self) -> Browser:
        self.folder = tempfile.TemporaryDirectory(prefix="browser-", ignore_cleanup_errors=True)
        options = [*OPTIONS, f"--user-data-dir={self.folder.name}"]
        if os.geteuid() == 0:  # its sandbox refuses root
            options.append("--no-sandbox")
        # It reads commands from file 3 and writes answers to file 4, each ended by a zero byte.
        reads, self.commands = os.pipe()
        self.answers, writes = os.pipe()
        command = ["bash", "-c", f'exec "$@" 3<&{reads} 4>&{writes}', "browser", chromium(), *options]
        silent = dict.fromkeys(("stdin", "stdout", "stderr"), subprocess.DEVNULL)
        self.process = subprocess.Popen(command, pass_fds=(reads, writes), **silent)
        os.close(reads)
        os.close(writes)
        self.number = 0
        self.rest = b""
        self.pages: dict[str, Page] = {}
        return self

    def __exit__(self, *_exception) -> None:
        self.process.terminate()
        try:
            self.process.wait(10)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        os.close(self.commands)
        os.close(self.answers)
        self.folder.cleanup()

    def call(self, method: str, session: str | None = None, **parameters: Any) -> dict:
        """Sends one command of the Chrome DevTools Protocol."""
        self.number += 1
        message = {"id": self.number, "method": method, "params": parameters}
        if session is not None:
            message["sessionId"] = session
        os.write(self.commands, json.dumps(message).encode() + b"\0")
        end = time.monotonic() + PATIENCE
        while True:
            answer = self._next(end - time.monotonic())
            if answer.get("id") == self.number:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']['message']}")
                return answer["result"]

    def wait(self, seconds: float) -> None:
        """Takes in what pages report meanwhile"""
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0:
            try:
                self._next(left)
            except TimeoutError:
                return

    def _next(self, patience: float) -> dict:
        while b"\0" not in self.rest:
            if not select.select([self.answers], [], [], max(0.0, patience))[0]:
                raise TimeoutError("the browser does not answer")
            part = os.read(self.answers, 1 << 20)
            if not part:
                raise RuntimeError("the browser has ended")
            self.rest += part
        text, _, self.rest = self.rest.partition(b"\0")
        message = json.loads(text)
        page = self.pages.get(message.get("sessionId", ""))
        if page is not None and "method" in message:
            page.heard(message["method"], message["params"])
        return message

    def open(self, file: Path, width: int = 1000, height: int = 800, dark: bool = False) -> Page:
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        page = self.pages[session] = Page(self, session, target, file.resolve().as_uri())
        for part in ("Page", "Runtime", "Network", "Log"):
            page.call(f"{part}.enable")
        scheme = {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}
        page.call("Emulation.setEmulatedMedia", features=[scheme])
        page.resize(width, height)
        page.call("Page.navigate", url=page.address)
        page.wait_for("document.readyState === 'complete'")
        return page


class Page:
    def __init__(self, browser: Browser, session: str, target: str, address: str):
        self.browser, self.session, self.target, self.address = browser, session, target, address
        self.complaints: list[str] = []
        self.requests: list[str] = []

    def call(self, method: str, **parameters: Any) -> dict:
        return self.browser.call(method, self.session, **parameters)

    def heard(self, event: str, about: dict) -> None:
        if event == "Runtime.exceptionThrown":
            details = about["exceptionDetails"]
            self.complaints.append(details.get("exception", {}).get("description", details["text"]))
        elif event == "Runtime.consoleAPICalled" and about["type"] in ("error", "assert", "warning"):
            self.complaints.append(" ".join(str(one.get("value", one)) for one in about["args"]))
        elif event == "Log.entryAdded" and about["entry"]["level"] == "error":
            self.complaints.append(about["entry"]["text"])
        elif event == "Network.requestWillBeSent":
            address = about["request"]["url"]
            if address != self.address and not address.startswith(("data:", "blob:")):
                self.requests.append(address)

    def run(self, script: str) -> Any:
        """Returns the value of an expression, or what a promise comes to."""
        answer = self.call("Runtime.evaluate", expression=script, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in answer:
            raise RuntimeError(answer["exceptionDetails"]["exception"]["description"])
        return answer["result"].get("value")

    def wait_for(self, condition: str, patience: float = PATIENCE) -> None:
        end = time.monotonic() + patience
        while not self.run(condition):
            if time.monotonic() > end:
                raise TimeoutError(f"{condition} does not come true; {self.complaints}")
            self.browser.wait(0.05)

    def resize(self, width: int, height: int) -> None:
        size = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False}
        self.call("Emulation.setDeviceMetricsOverride", **size)

    def mouse(self, kind: str, x: float, y: float, **more: Any) -> None:
        self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, **more)

    def touch(self, kind: str, points: list[tuple[float, float]]) -> None:
        self.call("Input.dispatchTouchEvent", type=kind, touchPoints=[{"x": x, "y": y} for x, y in points])

    def png(self, whole: bool = False) -> bytes:
        answer = self.call("Page.captureScreenshot", format="png", captureBeyondViewport=whole)
        return base64.b64decode(answer["data"])

    def picture(self) -> np.ndarray:
        return np.array(Image.open(io.BytesIO(self.png())).convert("RGB"))

    def stage(self) -> np.ndarray:
        """Of an animation, the picture of the bodies alone, once it is on the screen"""
        rectangle = "document.querySelector('.stage canvas').getBoundingClientRect()"
        left, top, width, height = self.run(f"(r => [r.left, r.top, r.width, r.height])({rectangle})")
        self.drawn()
        return self.picture()[int(top) : int(top + height), int(left) : int(left + width)].astype(int)

    def drawn(self, time: float | None = None) -> None:
        """Waits until an animation, sent to the time if there is one, is on the screen"""
        if time is not None:
            self.run(f"contactAnimation.seek({time})")
        self.run("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")

    def close(self) -> None:
        self.browser.call("Target.closeTarget", targetId=self.target)
