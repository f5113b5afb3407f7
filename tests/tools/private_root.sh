#!/bin/sh
# Used by private_root.py: creates a private root and starts its first process.
# REQUIRES: root, in new namespaces for mounts, processes, network, names and cgroups (unshare).
# private_root.sh FOLDER COMMAND [ARGUMENT ..]
#
# FOLDER is an empty directory. All writes are in memory and are lost with the last process. Kernel
# settings (/proc/sys, /sys) are read-only.
set -eu
base=$1
shift

mount --make-rprivate /
mount -t tmpfs -o size=2g fieldcast-root "$base"
mkdir "$base/upper" "$base/work" "$base/root"
mount -t overlay -o "lowerdir=/,upperdir=$base/upper,workdir=$base/work" overlay "$base/root"
cd "$base/root"

mount -t proc proc proc
mount --bind proc/sys proc/sys
mount -o remount,bind,ro proc/sys
mount -t sysfs -o ro sysfs sys
mount -t cgroup2 cgroup2 sys/fs/cgroup
mount -t tmpfs -o mode=755 dev dev
while read -r name major minor; do mknod -m 666 "dev/$name" c "$major" "$minor"; done <<DEVICES
null 1 3
zero 1 5
full 1 7
random 1 8
urandom 1 9
tty 5 0
DEVICES
mkdir dev/pts dev/shm
mount -t devpts -o newinstance,ptmxmode=0666,mode=620,gid=5 devpts dev/pts
mount -t tmpfs -o mode=1777 shm dev/shm
ln -s pts/ptmx dev/ptmx
ln -s /proc/self/fd dev/fd
for number in 0 1 2; do ln -s /proc/self/fd/$number dev/$(echo stdin stdout stderr | cut -d' ' -f$((number + 1))); done
mount -t tmpfs -o mode=755 run run
mount -t tmpfs -o mode=1777 tmp tmp
ip link set lo up

# Packages start services here, also if this machine is a container that forbids it.
rm -f usr/sbin/policy-rc.d

# Excludes only units that would change this machine.
: >etc/fstab
for unit in systemd-sysctl.service systemd-modules-load.service systemd-remount-fs.service systemd-timesyncd.service \
  systemd-networkd.service systemd-networkd-wait-online.service NetworkManager-wait-online.service systemd-resolved.service \
  systemd-udevd.service systemd-udev-trigger.service sys-kernel-debug.mount sys-kernel-tracing.mount; do
  ln -sf /dev/null "etc/systemd/system/$unit"
done
cat >etc/systemd/system/private-root.target <<UNIT
[Unit]
Description=A root of its own
Requires=sysinit.target
After=sysinit.target
UNIT

mkdir old
pivot_root . old
cd /
umount -l /old
exec env -i container=private-root PATH=/usr/sbin:/usr/bin:/sbin:/bin LC_ALL=C.UTF-8 "$@" </dev/null
