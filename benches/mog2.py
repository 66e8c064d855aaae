"""Times OpenCV's MOG2 with its defaults on one thread, once for each line on standard input.

Arguments: a file of raw frames that begins with the background, their width and height, and the repeats in a round.
Prints the milliseconds a frame for each line.
"""

import sys
import time

import cv2
import numpy

path, width, height, repeats = sys.argv[1], *map(int, sys.argv[2:])
cv2.setNumThreads(1)
frames = numpy.fromfile(path, numpy.uint8).reshape(-1, height, width, 3)
subtractor = cv2.createBackgroundSubtractorMOG2()
mask = subtractor.apply(frames[0])
images = frames[1:]


def run():
    for image in images:
        subtractor.apply(image, mask)


for _ in sys.stdin:
    run()
    start = time.thread_time()
    for _ in range(repeats):
        run()
    print(1e3 * (time.thread_time() - start) / (repeats * len(images)), flush=True)
