"""Drives a Chromium without a window through its debugging pipe: open a page, ask it, click, take pictures. Needs nothing but Python's own library."""

import base64
import fcntl
import json
import os
import select
import shutil
import struct
import subprocess
import tempfile
import time
import zlib

NAMES = ("chromium", "chromium-browser", "google-chrome")


def find():
    """The program; None if there is none."""
    return next((path for path in map(shutil.which, NAMES) if path), None)


class Chromium:
    """A browser with one page, whose graphics card is software."""

    def __init__(self, width=1280, height=800, phone=False):
        self.folder = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        (reads, self.to), (self.answers, writes) = os.pipe(), os.pipe()
        # The browser reads from 3 and writes to 4, which may be others here.
        reads, writes = (fcntl.fcntl(end, fcntl.F_DUPFD, 50) for end in (reads, writes))

        def arrange():
            os.dup2(reads, 3)
            os.dup2(writes, 4)

        command = [find(), "--headless", "--no-sandbox", "--remote-debugging-pipe", f"--user-data-dir={self.folder.name}/profile"]
        command += ["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist", "--disable-dev-shm-usage"]
        command += ["--hide-scrollbars", "--no-first-run", "--disable-background-networking", f"--window-size={width},{height}", "about:blank"]
        self.log = open(f"{self.folder.name}/log", "wb")
        self.process = subprocess.Popen(
            command, stdin=subprocess.DEVNULL, stdout=self.log, stderr=self.log, pass_fds=(3, 4), preexec_fn=arrange
        )
        for end in (reads, writes):
            os.close(end)
        self.number, self.rest, self.told = 0, b"", []
        target = next(t for t in self.ask("Target.getTargets", session=None)["targetInfos"] if t["type"] == "page")
        self.session = self.ask("Target.attachToTarget", targetId=target["targetId"], flatten=True, session=None)["sessionId"]
        self.ask("Page.enable")
        self.ask("Runtime.enable")
        self.ask("Log.enable")
        self.resize(width, height, phone)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.terminate()
        try:
            self.process.wait(20)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        self.log.close()
        self.folder.cleanup()

    def _message(self, seconds):
        """The next message; None if none comes in time."""
        end = time.monotonic() + seconds
        while b"\0" not in self.rest:
            ready, _, _ = select.select([self.answers], [], [], max(end - time.monotonic(), 0))
            if not ready:
                return None
            part = os.read(self.answers, 1 << 20)
            if not part:
                raise SystemExit("the browser has ended")
            self.rest += part
        message, self.rest = self.rest.split(b"\0", 1)
        return json.loads(message)

    def ask(self, method, session="own", seconds=120, **parameters):
        """The answer to a command."""
        self.number += 1
        message = {"id": self.number, "method": method, "params": parameters}
        if session == "own":
            message["sessionId"] = self.session
        os.write(self.to, json.dumps(message).encode() + b"\0")
        end = time.monotonic() + seconds
        while True:
            answer = self._message(end - time.monotonic())
            if answer is None:
                raise SystemExit(f"the browser does not answer {method}")
            if answer.get("id") == self.number:
                if "error" in answer:
                    raise SystemExit(f"{method}: {answer['error']['message']}")
                return answer["result"]
            self._note(answer)

    def _note(self, event):
        """Keeps what the page complains of."""
        parameters = event.get("params", {})
        if event.get("method") == "Runtime.exceptionThrown":
            details = parameters["exceptionDetails"]
            self.told.append(details.get("exception", {}).get("description") or details["text"])
        elif event.get("method") == "Log.entryAdded" and parameters["entry"]["level"] == "error":
            self.told.append(f"{parameters['entry']['text']} {parameters['entry'].get('url', '')}".strip())

    def resize(self, width, height, phone=False):
        self.ask("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=2 if phone else 1, mobile=phone)
        self.ask("Emulation.setTouchEmulationEnabled", enabled=phone)

    def open(self, address):
        self.ask("Page.navigate", url=address)
        self.wait("document.readyState === 'complete'")

    def evaluate(self, expression, seconds=120):
        """The value of an expression in the page, which may be a promise."""
        found = self.ask("Runtime.evaluate", expression=expression, awaitPromise=True, returnByValue=True, seconds=seconds)
        if "exceptionDetails" in found:
            details = found["exceptionDetails"]
            raise SystemExit(f"{expression}: {details.get('exception', {}).get('description') or details['text']}")
        return found["result"].get("value")

    def wait(self, condition, seconds=60):
        """Waits until an expression is true."""
        end = time.monotonic() + seconds
        while not self.evaluate(f"Boolean({condition})"):
            if time.monotonic() > end:
                raise SystemExit(f"in {seconds} s not true: {condition}\nthe page has told: {self.told}")
            time.sleep(0.05)

    def click(self, x, y):
        for kind in ("mousePressed", "mouseReleased"):
            self.ask("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", buttons=int(kind == "mousePressed"), clickCount=1)

    def tap(self, x, y):
        """A finger on a place and off again."""
        self.ask("Input.dispatchTouchEvent", type="touchStart", touchPoints=[{"x": x, "y": y, "id": 0}])
        self.ask("Input.dispatchTouchEvent", type="touchEnd", touchPoints=[])

    def key(self, key, code=None, text=""):
        """A key on what has the focus."""
        for kind in ("keyDown", "keyUp"):
            self.ask("Input.dispatchKeyEvent", type=kind, key=key, code=code or key, text=text if kind == "keyDown" else "", windowsVirtualKeyCode=32 if key == " " else 0)

    def drag(self, start, end, steps=6, button="left"):
        bits = {"left": 1, "right": 2}[button]
        self.ask("Input.dispatchMouseEvent", type="mousePressed", x=start[0], y=start[1], button=button, buttons=bits, clickCount=1)
        for k in range(1, steps + 1):
            x, y = (start[a] + (end[a] - start[a]) * k / steps for a in (0, 1))
            self.ask("Input.dispatchMouseEvent", type="mouseMoved", x=x, y=y, button=button, buttons=bits)
        self.ask("Input.dispatchMouseEvent", type="mouseReleased", x=end[0], y=end[1], button=button, buttons=0, clickCount=1)

    def wheel(self, x, y, down):
        self.ask("Input.dispatchMouseEvent", type="mouseWheel", x=x, y=y, deltaX=0, deltaY=down)

    def pinch(self, x, y, before, after, steps=6):
        """Two fingers beside a place, so many pixels from it before and after."""

        def fingers(apart):
            return [{"x": x - apart, "y": y, "id": 0}, {"x": x + apart, "y": y, "id": 1}]

        self.ask("Input.dispatchTouchEvent", type="touchStart", touchPoints=fingers(before))
        for k in range(1, steps + 1):
            self.ask("Input.dispatchTouchEvent", type="touchMove", touchPoints=fingers(before + (after - before) * k / steps))
        self.ask("Input.dispatchTouchEvent", type="touchEnd", touchPoints=[])

    def press(self, selector):
        """Clicks the middle of an element."""
        self.evaluate(f"document.querySelector({json.dumps(selector)}).scrollIntoView({{ block: 'nearest' }})")
        x, y = self.middle(selector)
        self.click(x, y)

    def middle(self, selector):
        box = f"document.querySelector({json.dumps(selector)}).getBoundingClientRect()"
        return self.evaluate(f"(() => {{ const b = {box}; return [b.x + b.width / 2, b.y + b.height / 2]; }})()")

    def choose(self, selector, value):
        """Takes an option of a list, or sets the value of a slider or text."""
        self.evaluate(
            f"(() => {{ const e = document.querySelector({json.dumps(selector)}); e.value = {json.dumps(value)};"
            " for (const kind of ['input', 'change']) e.dispatchEvent(new Event(kind, { bubbles: true })); })()"
        )

    def png(self):
        return base64.b64decode(self.ask("Page.captureScreenshot", format="png")["data"])

    def picture(self):
        return Picture(self.png())


class Picture:
    """A PNG of eight bits a channel as the browser writes it."""

    def __init__(self, png):
        at, data = 8, b""
        while at < len(png):
            length, kind = struct.unpack(">I4s", png[at : at + 8])
            body = png[at + 8 : at + 8 + length]
            if kind == b"IHDR":
                self.width, self.height, _, color = struct.unpack(">IIBB", body[:10])
                self.channels = {2: 3, 6: 4}[color]
            elif kind == b"IDAT":
                data += body
            at += 12 + length
        raw, stride, n = zlib.decompress(data), self.width * self.channels, self.channels
        self.rows, before = [], bytearray(stride)
        for row in range(self.height):
            start = row * (stride + 1)
            filtered, line = raw[start], bytearray(raw[start + 1 : start + 1 + stride])
            for i in range(stride if filtered else 0):
                left = line[i - n] if i >= n else 0
                corner = before[i - n] if i >= n else 0
                up = before[i]
                if filtered == 1:
                    guess = left
                elif filtered == 2:
                    guess = up
                elif filtered == 3:
                    guess = (left + up) // 2
                else:
                    p = left + up - corner
                    guess = min((abs(p - left), 0, left), (abs(p - up), 1, up), (abs(p - corner), 2, corner))[2]
                line[i] = (line[i] + guess) & 255
            self.rows.append(line)
            before = line

    def at(self, x, y):
        start = int(x) * self.channels
        return tuple(self.rows[int(y)][start : start + 3])
