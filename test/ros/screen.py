"""An X server without a screen, for rviz."""
import os
import subprocess


class Screen:
    """An X server without a screen, on a display that is free."""

    def __init__(self):
        reading, writing = os.pipe()
        self._process = subprocess.Popen(["Xvfb", "-displayfd", str(writing), "-screen", "0", "1024x768x24"],
                                         pass_fds=[writing], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(writing)
        with os.fdopen(reading) as answer:
            self.name = ":" + answer.readline().strip()
        os.environ.update(DISPLAY=self.name, LIBGL_ALWAYS_SOFTWARE="1", QT_QPA_PLATFORM="xcb")

    def close(self):
        self._process.terminate()
        self._process.wait()
