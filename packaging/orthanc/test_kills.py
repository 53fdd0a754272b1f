#!/usr/bin/env python3
"""Kills Orthanc, clipgs archive and its builds (kill -9) at random moments while series of several patients arrive by
C-STORE, and looks at what came of it: no series lost, none built twice of the same images, none mixed up, nothing of a
patient beside the archive. Everything is on loopback and below a temporary folder.

  test_kills.py CLIPGS [--kills 50] [--seed 1] [--data FOLDER]

Needs Debian's orthanc and dcmtk, and numpy. FOLDER holds folders of DICOM series to send beside the phantoms. Prints
what was done, and ends with 1 at the first thing that is wrong. As root it also tries a full disk."""
import argparse
import base64
import collections
import json
import os
import pathlib
import random
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
import urllib.request

HERE = pathlib.Path(__file__).resolve().parent
AS_DICOM = HERE.parent.parent / "bench" / "as_dicom.py"
BUILD = {"quality": "draft", "size": 48, "train-frames": 8, "test-frames": 1, "steps": 120, "budget": 1500,
         "as-scanned": True}
SETTLE = 3


def run(*words, **more):
    return subprocess.run([str(word) for word in words], check=True, capture_output=True, **more)


def free_port():
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


def expect(holds, what):
    if not holds:
        sys.exit(f"test_kills: {what}")


class Orthanc:
    def __init__(self, work):
        self.work, self.http, self.dicom, self.process = work, free_port(), free_port(), None
        self.wake = work / "wake"
        self.wake.touch()
        lua = work / "clipgs.lua"
        lua.write_text((HERE / "clipgs.lua").read_text().replace("/run/clipgs-archive.wake", str(self.wake)))
        (work / "orthanc.json").write_text(json.dumps({
            "StorageDirectory": str(work / "storage"), "HttpPort": self.http, "DicomPort": self.dicom, "StableAge": 1,
            "RemoteAccessAllowed": False, "AuthenticationEnabled": True, "RegisteredUsers": {"clipgs": "secret"},
            "LuaScripts": [str(lua)], "Plugins": []}))

    def start(self):
        log = open(self.work / "orthanc.log", "a")
        self.process = subprocess.Popen(["/usr/sbin/Orthanc", self.work / "orthanc.json"], stdout=log, stderr=log)

    def ask(self, path):
        request = urllib.request.Request(f"http://127.0.0.1:{self.http}{path}", headers={
            "Authorization": "Basic " + base64.b64encode(b"clipgs:secret").decode()})
        with urllib.request.urlopen(request, timeout=10) as answer:
            return answer.read()

    def json(self, path):
        return json.loads(self.ask(path))

    def wait(self):
        for _ in range(200):
            try:
                return self.json("/system")
            except OSError:
                time.sleep(0.1)
        return expect(False, "Orthanc does not start")


class Worker:
    def __init__(self, clipgs, work, rules):
        self.words = [clipgs, "archive", rules, "-o", work / "cases", "--state", work / "state"]
        self.log, self.process = work / "worker.log", None

    def start(self):
        log = open(self.log, "a")
        self.process = subprocess.Popen([str(word) for word in self.words], stdout=log, stderr=log)

    def builds(self):
        try:
            pid = self.process.pid
            return [int(p) for p in pathlib.Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]
        except OSError:
            return []


class Series(collections.namedtuple("Series", "folder patient files")):
    """Images that are sent, and the name of whose they are."""


def write_rules(work, orthanc, **changes):
    credentials = work / "credentials"
    credentials.write_text("clipgs:secret\n")
    credentials.chmod(0o600)
    rules = {"clipgs_archive": 1, "orthanc": f"http://127.0.0.1:{orthanc.http}", "credentials": str(credentials),
             "public_url": "https://cases.example/", "wake": str(orthanc.wake), "settle_seconds": SETTLE,
             "poll_seconds": 1, "tries": 1000, "retry_seconds": 1, "film_pictures": 6, "film_size": 96,
             "rules": [{"name": "ct", "modality": "CT", "build": BUILD}]}
    (work / "rules.json").write_text(json.dumps({**rules, **changes}))
    return work / "rules.json"


def make_series(clipgs, work, data):
    """Of each a patient of its own, but for two that share one."""
    found = []
    for number in range(5):
        patient = f"ZQX7^Phantom{min(number, 3)}"
        folder = work / "in" / f"phantom{number}"
        volume = work / "phantom.nrrd"
        run(clipgs, "phantom", volume, "--size", 36 + 4 * number, "--quiet")
        run("/usr/bin/python3", AS_DICOM, volume, folder, "--patient", patient, "--id", f"zqx7-{min(number, 3)}",
            "--number", number + 1)
        found.append((folder, patient))
    for number, source in enumerate(sorted(data.iterdir()) if data else []):
        folder = work / "in" / source.name
        shutil.copytree(source, folder, copy_function=shutil.copyfile)
        folder.chmod(0o755)
        patient = f"ZQX7^Real{number}"
        values = {"0008,0016": "1.2.840.10008.5.1.4.1.1.2", "0010,0010": patient, "0010,0020": f"zqx7-r{number}",
                  "0020,000d": f"1.2.826.0.1.3680043.2.1125.78.{number}", "0020,000e":
                  f"1.2.826.0.1.3680043.2.1125.78.{number}.1"}  # some are anonymised, without any
        insert = [word for tag, value in values.items() for word in ("-i", f"({tag})={value}")]
        run("dcmodify", "-nb", "-gin", *insert, *folder.iterdir())
        found.append((folder, patient))
    return [Series(folder, patient, sorted(folder.iterdir())) for folder, patient in found]


def send(orthanc, series, chance, stop):
    """As a scanner does: a few images at a time, each until it is taken."""
    files = list(series.files)
    time.sleep(chance.uniform(0, 45))
    while files and not stop.is_set():
        some = files[:chance.randint(4, 12)]
        sent = subprocess.run(["storescu", "-xv", "-aec", "ORTHANC", "-to", "5", "127.0.0.1", str(orthanc.dicom),
                               *map(str, some)], capture_output=True).returncode == 0
        files = files[len(some):] if sent else files
        # Sometimes for longer than a series takes to be held for complete.
        time.sleep(chance.choice([0.2, 1, 2 * SETTLE + 3]) * chance.uniform(0.5, 1) if sent else 0.5)


def kill_around(orthanc, worker, kills, chance):
    """`kills` times one of the three; returns how often each."""
    done = collections.Counter()
    while sum(done.values()) < kills:
        time.sleep(chance.uniform(0.2, 2.5))
        what = chance.choice(["Orthanc", "worker", "build"])
        builds = worker.builds()
        if what == "build" and not builds:
            continue
        if what == "build":
            os.kill(builds[0], signal.SIGKILL)
        else:
            one = orthanc if what == "Orthanc" else worker
            one.process.kill()
            one.process.wait()
            time.sleep(chance.uniform(0, 1))
            one.start()
        done[what] += 1
    return done


def records(work):
    return [json.loads(file.read_text()) for file in (work / "state").glob("*.json")]


def wait_until_done(orthanc, work, count, seconds=900):
    end = time.time() + seconds
    while time.time() < end:
        time.sleep(1)
        try:
            settled = all(one["IsStable"] for one in orthanc.json("/series?expand"))
        except OSError:
            continue
        stages = [record["stage"] for record in records(work)]
        if settled and len(stages) == count and set(stages) == {"done"}:
            time.sleep(SETTLE + 3)  # a late image would begin again
            if {record["stage"] for record in records(work)} == {"done"}:
                return
    expect(False, f"not all done after {seconds} s: {records(work)}")


def tags(orthanc, series):
    return orthanc.json(f"/instances/{series['Instances'][0]}/simplified-tags")


def check(clipgs, orthanc, work, sent):
    every = orthanc.json("/series?expand")
    sources = {one["ID"]: one for one in every if one["MainDicomTags"]["Modality"] == "CT"}
    expect(len(sources) == len(sent), f"{len(sources)} series of {len(sent)} are in Orthanc")
    films = collections.defaultdict(list)
    by_image = {}
    for id_, one in sources.items():
        for instance in orthanc.json(f"/series/{id_}/instances"):
            by_image[instance["MainDicomTags"]["SOPInstanceUID"]] = id_
    for one in every:
        if one["ID"] in sources:
            continue
        said = tags(orthanc, one)
        items = said.get("SourceImageSequence") or said["SourceInstanceSequence"]
        images = sorted(item["ReferencedSOPInstanceUID"] for item in items)
        of = {by_image[image] for image in images}
        expect(len(of) == 1, "a derived object is of images of several series")
        source = sources[of.pop()]
        expect(said["PatientName"] == tags(orthanc, source)["PatientName"], "a derived object has another patient")
        expect(len(one["Instances"]) == 1, "a derived object is there twice")
        films[source["ID"], one["MainDicomTags"]["Modality"]].append(images)
    log = (work / "worker.log").read_text()
    for series in sent:
        ours = [one for one in sources.values() if tags(orthanc, one)["PatientName"] == series.patient
                and len(one["Instances"]) == len(series.files)]
        expect(len(ours) == 1, f"of {series.folder.name} not all images are in Orthanc")
        id_ = ours[0]["ID"]
        name = orthanc.ask(f"/series/{id_}/metadata/1024").decode().rsplit("=", 1)[1]
        for modality in ("OT", "DOC"):
            contents = films[id_, modality]
            expect(len({tuple(one) for one in contents}) == len(contents), "two objects are of the same images")
            expect(sum(len(one) == len(series.files) for one in contents) == 1, "no object of all images")
        built = len(re.findall(f"^{name}: built in", log, re.M))
        expect(built <= len(films[id_, "OT"]), f"{series.folder.name} was built {built} times")
        by_hand = work / "by-hand" / f"{series.folder.name}.sog"
        by_hand.parent.mkdir(exist_ok=True)
        words = [word for key, value in BUILD.items() for word in [f"--{key}"] + ([] if value is True else [value])]
        run(clipgs, "build", series.folder, "-o", by_hand, "--quiet", *words)
        expect(by_hand.read_bytes() == (work / "cases" / f"{name}.sog").read_bytes(),
               f"the case of {series.folder.name} is not what clipgs build makes of it")
    expect(len(list((work / "cases").iterdir())) == len(sent), "there are more cases than series")
    return {key[1]: sum(len(value) for other, value in films.items() if other[1] == key[1]) for key in films}


def check_nothing_left(work):
    for folder in (work / "cases", work / "state"):
        for file in folder.rglob("*"):
            expect(file.name != "images" and not file.name.endswith(".part"), f"{file} was left")
            text = (file.read_bytes() if file.is_file() else b"") + str(file.relative_to(work)).encode()
            expect(b"zqx7" not in text.lower() and b"19010203" not in text, f"a patient is in {file}")
    log = (work / "worker.log").read_text().lower()
    expect("zqx7" not in log and "1.2.826" not in log, "a patient is in the log")


def try_second_and_end(worker):
    second = subprocess.run([str(word) for word in worker.words], capture_output=True, text=True)
    expect(second.returncode == 1 and "is at work here" in second.stderr, "a second worker was let in")
    worker.process.terminate()
    expect(worker.process.wait(20) == 0, "SIGTERM does not end it cleanly")


def try_full_disk(clipgs, orthanc, work):
    """State on a disk with room for the images, not for the work; then it grows."""
    state = work / "small"
    state.mkdir()
    mount = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=2m", "tmpfs", state], capture_output=True)
    if mount.returncode != 0:
        return "was not tried, as mount is not allowed"
    worker = Worker(clipgs, work, work / "rules.json")
    worker.words[-1] = state
    worker.words[4] = work / "cases-of-small"
    worker.log = work / "small.log"
    try:
        worker.start()
        for _ in range(300):
            time.sleep(0.1)
            if "disk is full" in worker.log.read_text():
                break
        expect("disk is full" in worker.log.read_text(), "a full disk is not told")
        expect(worker.process.poll() is None, "a full disk ended it")
        run("mount", "-o", "remount,size=400m", state)
        end = time.time() + 300
        count = len([one for one in orthanc.json("/series?expand") if one["MainDicomTags"]["Modality"] == "CT"])
        done = []
        while time.time() < end and len(done) < count:
            time.sleep(1)
            done = [file for file in state.glob("*.json") if json.loads(file.read_text())["stage"] == "done"]
        expect(len(done) == count, f"after a full disk {len(done)} of {count} were done")
        expect("failed" not in worker.log.read_text(), "a full disk counted as a failure")
        worker.process.terminate()
        worker.process.wait(20)
    finally:
        worker.process.kill()
        worker.process.wait()
        run("umount", "-l", state)
    return "was told, and the work went on when there was room"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("clipgs", type=lambda text: pathlib.Path(text).resolve())
    parser.add_argument("--kills", type=int, default=50)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--data", type=pathlib.Path)
    options = parser.parse_args()
    os.environ["SOURCE_DATE_EPOCH"] = "1800000000"
    chance = random.Random(options.seed)
    work = pathlib.Path(tempfile.mkdtemp(prefix="clipgs-kills-"))
    sent = make_series(options.clipgs, work, options.data)
    orthanc = Orthanc(work)
    worker = Worker(options.clipgs, work, write_rules(work, orthanc))
    stop = threading.Event()
    try:
        orthanc.start()
        orthanc.wait()
        worker.start()
        senders = [threading.Thread(target=send, args=(orthanc, one, random.Random(options.seed + i), stop))
                   for i, one in enumerate(sent)]
        for sender in senders:
            sender.start()
        killed = kill_around(orthanc, worker, options.kills, chance)
        for sender in senders:
            sender.join()
        wait_until_done(orthanc, work, len(sent))
        made = check(options.clipgs, orthanc, work, sent)
        try_second_and_end(worker)
        check_nothing_left(work)
        full = try_full_disk(options.clipgs, orthanc, work)
        print(f"{len(sent)} series, {sum(len(one.files) for one in sent)} images, killed: {dict(killed)}; "
              f"in Orthanc: {made}; a full disk {full}")
    except SystemExit:
        print(f"test_kills: everything is left in {work}", file=sys.stderr)
        raise
    finally:
        stop.set()
        for one in (orthanc, worker):
            if one.process:
                one.process.kill()
    shutil.rmtree(work)


if __name__ == "__main__":
    main()
