#!/usr/bin/env python3
"""Writes a container image with two layers: Debian's libraries, and the programs of packages.

usage: oci_image.py ARCH VERSION LIBRARIES.tar OUTPUT.tar PACKAGE.deb..

OUTPUT.tar is an OCI image layout with the file `manifest.json` of `docker save`, so that old and
new engines load it. The same input gives the same bytes: SOURCE_DATE_EPOCH limits each time, and
the names of files determine their order.
"""

import fnmatch
import gzip
import hashlib
import io
import json
import os
import subprocess
import sys
import tarfile
import time

USER_ID = 10001  # the same in each image, because the owner of a volume is a number
DIALOUT_ID = 20  # Debian's number of the group that may open serial devices
DATA = "var/lib/fieldcast"

# Files that no program of the image reads. A pattern of KEPT has priority.
LEFT_OUT = [
    "boot", "dev/*", "home", "media", "mnt", "opt", "proc/*", "root/*", "run/*", "srv", "sys/*", "tmp/*",
    "etc/apt", "etc/cron*", "etc/debian_version", "etc/dpkg", "etc/host.conf", "etc/hostname", "etc/issue*", "etc/logrotate.d", "etc/motd",
    "etc/profile*", "etc/resolv.conf", "etc/skel", "etc/update-motd.d",
    "usr/bin/*", "usr/sbin/*", "usr/games", "usr/include", "usr/lib/systemd", "usr/lib/sysusers.d", "usr/lib/udev", "usr/lib/tmpfiles.d",
    "usr/local", "usr/src", "usr/share/bash-completion", "usr/share/base-files", "usr/share/bug", "usr/share/dict", "usr/share/doc-base",
    "usr/share/doc/*/*", "usr/share/fieldcast/grafana", "usr/share/fieldcast/wireshark", "usr/share/gcc", "usr/share/gdb", "usr/share/info",
    "usr/share/lintian", "usr/share/locale", "usr/share/man", "usr/share/misc",
    "var/backups", "var/cache", "var/lib/apt", "var/lib/dpkg/*", "var/lib/misc", "var/local", "var/log", "var/mail", "var/opt", "var/spool",
]
KEPT = ["usr/bin/fieldcast*", "usr/share/doc/*/copyright", "var/lib/dpkg/status.d"]

ACCOUNTS = {
    "etc/passwd": f"root:x:0:0:root:/root:/usr/sbin/nologin\nfieldcast:x:{USER_ID}:{USER_ID}:Fieldcast:/{DATA}:/usr/sbin/nologin\n",
    "etc/group": f"root:x:0:\ndialout:x:{DIALOUT_ID}:\nfieldcast:x:{USER_ID}:\n",
    "etc/nsswitch.conf": "passwd: files\ngroup: files\nhosts: files dns\n",
}


def is_kept(name):
    """Returns whether the image has the file. A pattern also covers everything below its match."""
    folders = name.split("/")
    heads = ["/".join(folders[:count]) for count in range(1, len(folders) + 1)]
    matches = lambda patterns: any(fnmatch.fnmatchcase(head, pattern) for head in heads for pattern in patterns)
    return matches(KEPT) or not matches(LEFT_OUT)


class Layer:
    def __init__(self, latest):
        self.latest = latest
        self.members = {}  # name -> (header, content); a later file replaces an earlier one

    def add(self, header, content=None):
        header.mtime = min(int(header.mtime), self.latest)
        header.uname = header.gname = ""
        header.pax_headers = {}
        self.members[header.name] = header, content

    def add_tar(self, stream):
        """Adds the kept files of an archive with names such as ./usr/bin/fieldcast."""
        with tarfile.open(fileobj=stream, mode="r|*") as archive:
            for header in archive:
                header.name = header.name.removeprefix("./").strip("/")
                if header.islnk():
                    header.linkname = header.linkname.removeprefix("./")
                if header.name not in ("", ".") and is_kept(header.name):
                    self.add(header, archive.extractfile(header).read() if header.isreg() else None)

    def add_file(self, name, text):
        header = tarfile.TarInfo(name)
        header.size, header.mode, header.mtime = len(text), 0o644, self.latest
        self.add(header, text)

    def add_folder(self, name, mode, owner=0):
        header = tarfile.TarInfo(name)
        header.type, header.mode, header.mtime, header.uid, header.gid = tarfile.DIRTYPE, mode, self.latest, owner, owner
        self.add(header)

    def tar(self):
        in_order = lambda item: (item[1][0].islnk(), item[0])  # a hard link after its target
        bytes_of_tar = io.BytesIO()
        with tarfile.open(fileobj=bytes_of_tar, mode="w", format=tarfile.GNU_FORMAT) as archive:
            for _, (header, content) in sorted(self.members.items(), key=in_order):
                archive.addfile(header, io.BytesIO(content) if content is not None else None)
        return bytes_of_tar.getvalue()


class Archive:
    """The files of OUTPUT.tar; a blob is named by its digest."""

    def __init__(self):
        self.files = {}

    def blob(self, media_type, content):
        digest = hashlib.sha256(content).hexdigest()
        self.files[f"blobs/sha256/{digest}"] = content
        return {"mediaType": media_type, "digest": f"sha256:{digest}", "size": len(content)}

    def json_blob(self, media_type, value):
        return self.blob(media_type, json_bytes(value))

    def write(self, path):
        with tarfile.open(path, "w", format=tarfile.GNU_FORMAT) as archive:
            for name, content in sorted(self.files.items()):
                header = tarfile.TarInfo(name)
                header.size, header.mode = len(content), 0o644
                archive.addfile(header, io.BytesIO(content))


def json_bytes(value):
    return json.dumps(value, indent=1, sort_keys=True).encode()


def blob_path(descriptor):
    return "blobs/" + descriptor["digest"].replace(":", "/")


def image(arch, version, created, layers):
    """Returns the archive, the digest of the image, and the bytes of its layers without compression."""
    archive, oci = Archive(), "application/vnd.oci.image"
    tars = [layer.tar() for layer in layers]
    blobs = [archive.blob(f"{oci}.layer.v1.tar+gzip", gzip.compress(tar, 6, mtime=0)) for tar in tars]
    instant = time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime(created))
    labels = {"org.opencontainers.image.title": "Fieldcast", "org.opencontainers.image.version": version}
    config = archive.json_blob(f"{oci}.config.v1+json", {
        "created": instant, "os": "linux",
        **{"amd64": {"architecture": "amd64"}, "arm64": {"architecture": "arm64", "variant": "v8"},
           "armhf": {"architecture": "arm", "variant": "v7"}}[arch],
        "config": {
            "User": f"{USER_ID}:{USER_ID}", "WorkingDir": f"/{DATA}", "StopSignal": "SIGTERM", "Volumes": {f"/{DATA}": {}},
            "Env": ["PATH=/usr/bin", f"HOME=/{DATA}", "LANG=C.UTF-8"],
            "Cmd": ["fieldcast-bridge", "/etc/fieldcast/bridge.yaml"], "Labels": labels,
        },
        "rootfs": {"type": "layers", "diff_ids": ["sha256:" + hashlib.sha256(tar).hexdigest() for tar in tars]},
        "history": [{"created": instant, "created_by": f"tools/image.sh: {part}"} for part in ("libraries of Debian", "Fieldcast")],
    })
    manifest = archive.json_blob(f"{oci}.manifest.v1+json", {
        "schemaVersion": 2, "mediaType": f"{oci}.manifest.v1+json", "config": config, "layers": blobs, "annotations": labels})
    manifest["annotations"] = {"org.opencontainers.image.ref.name": version, "io.containerd.image.name": f"docker.io/library/fieldcast:{version}"}
    archive.files["oci-layout"] = json_bytes({"imageLayoutVersion": "1.0.0"})
    archive.files["index.json"] = json_bytes({
        "schemaVersion": 2, "mediaType": f"{oci}.index.v1+json", "manifests": [manifest]})
    archive.files["manifest.json"] = json_bytes([{
        "Config": blob_path(config), "RepoTags": [f"fieldcast:{version}", "fieldcast:latest"], "Layers": [blob_path(blob) for blob in blobs]}])
    return archive, manifest["digest"], sum(map(len, tars))


def main():
    arch, version, libraries_path, output, *packages = sys.argv[1:]
    created = int(os.environ["SOURCE_DATE_EPOCH"])
    libraries, programs = Layer(created), Layer(created)
    with open(libraries_path, "rb") as file:
        libraries.add_tar(file)
    for name, text in ACCOUNTS.items():
        libraries.add_file(name, text.encode())
    for package in packages:
        programs.add_tar(io.BytesIO(subprocess.run(["dpkg-deb", "--fsys-tarfile", package], check=True, capture_output=True).stdout))
        status = subprocess.run(["dpkg-deb", "-f", package], check=True, capture_output=True).stdout
        programs.add_file("var/lib/dpkg/status.d/" + os.path.basename(package).split("_")[0], status)
    programs.add_folder("etc/fieldcast", 0o755)
    programs.add_folder(DATA, 0o750, USER_ID)
    archive, digest, size = image(arch, version, created, [libraries, programs])
    archive.write(output)
    print(f"{output}: {os.path.getsize(output) / 1e6:.1f} MB, {size / 1e6:.1f} MB without compression, {digest}")


if __name__ == "__main__":
    main()
