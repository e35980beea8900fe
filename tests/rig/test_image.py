"""The process image: what is told at once, what is kept, and what a kill leaves."""

import threading

import numpy as np
import pytest

from clepsydra.rig.image import ImageLayout, ImageOfAnother, ProcessImage

LAYOUT = ImageLayout(("a", "b", "c"), ("u",), remembered=2)


def told(image, sample, value):
    image.publish(sample, float(sample), np.full(3, value))
    image.keep(image.published(), image.written())
    image.remember(sample + 1, [value, value])


def test_a_reader_never_sees_half_of_a_sample(tmp_path):
    image = ProcessImage(tmp_path / "image", LAYOUT, new=True)
    image.publish(0, 0.0, np.zeros(3))
    ended = threading.Event()

    def write():
        for sample in range(20_000):
            image.publish(sample, float(sample), np.full(3, float(sample)))
        ended.set()

    writer = threading.Thread(target=write)
    writer.start()
    seen = set()
    while not ended.is_set():
        found = image.published()
        assert np.all(found.values == found.values[0]) and found.time == found.values[0]
        seen.add(found.sample)
    writer.join()
    assert len(seen) > 1


def test_rows_are_kept_until_they_are_overwritten(tmp_path):
    image = ProcessImage(tmp_path / "image", LAYOUT, new=True)
    rows = LAYOUT.rows
    for sample in range(rows + 100):
        told(image, sample, float(sample))
    kept = image.kept_since(-1, most=10 * rows)
    assert kept[-1, 0] == rows + 99 and len(kept) == rows - 1
    assert np.array_equal(kept[:, 2], kept[:, 0])
    assert image.kept_since(rows + 97)[:, 0].tolist() == [rows + 98, rows + 99]


def test_a_sample_is_there_once_the_plant_remembers_what_came_after_it(tmp_path):
    image = ProcessImage(tmp_path / "image", LAYOUT, new=True)
    image.publish(0, 0.0, np.zeros(3))
    image.keep(image.published(), image.written())
    assert not len(image.kept_since(-1))
    image.remember(1, [0.0, 0.0])
    assert image.kept_since(-1)[:, 0].tolist() == [0.0]


def test_what_is_being_remembered_does_not_hide_what_was(tmp_path):
    image = ProcessImage(tmp_path / "image", LAYOUT, new=True)
    assert image.remembered() is None
    told(image, 4, 1.5)

    class Killed(Exception):
        pass

    class Numbers:
        def __array__(self, *_, **__):
            raise Killed

    with pytest.raises(Killed):
        image.remember(6, Numbers())
    sample, numbers = image.remembered()
    assert sample == 5 and numbers.tolist() == [1.5, 1.5]


def test_an_image_of_another_plant_is_refused(tmp_path):
    ProcessImage(tmp_path / "image", LAYOUT, new=True)
    other = ImageLayout(("a", "b", "d"), ("u",), remembered=2)
    with pytest.raises(ImageOfAnother):
        ProcessImage(tmp_path / "image", other)
    with pytest.raises(ImageOfAnother):
        ProcessImage(tmp_path / "image", ImageLayout(("a",), ("u",), remembered=2))


def test_who_was_killed_while_he_published_leaves_no_reader_in_doubt(tmp_path):
    image = ProcessImage(tmp_path / "image", LAYOUT, new=True)
    image.publish(0, 0.0, np.zeros(3))

    class Killed(Exception):
        pass

    class Numbers:
        def __array__(self, *_, **__):
            raise Killed

    with pytest.raises(Killed):
        image.publish(1, 1.0, Numbers())
    again = ProcessImage(tmp_path / "image", LAYOUT)
    again.publish(1, 1.0, np.ones(3))
    ended = threading.Event()

    def write():
        for sample in range(2, 20_000):
            again.publish(sample, float(sample), np.full(3, float(sample)))
        ended.set()

    writer = threading.Thread(target=write)
    writer.start()
    while not ended.is_set():
        found = image.published()
        assert np.all(found.values == found.values[0]) and found.time == found.values[0]
    writer.join()
    # Even once it stands still, so that nobody reads it a thousand times.
    assert int(image._head[1]) % 2 == 0
