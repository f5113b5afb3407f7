#!/bin/sh
# Creates a /sys with one USB serial adapter, to test udev rules without hardware.
# REQUIRES: its own mount namespace, in which /sys is replaced.
# usb_serial_tree.sh DRIVER SERIAL_NUMBER     empty if the adapter has no number
#
# The tty is /sys/class/tty/ttyUSB0, its adapter's port /sys/bus/usb-serial/devices/ttyUSB0.
set -eu
driver=$1 serial=$2
mount -t tmpfs sys /sys
adapter=/sys/devices/pci0000:00/0000:00:14.0/usb1/1-2
interface=$adapter/1-2:1.0
port=$interface/ttyUSB0
tty=$port/tty/ttyUSB0
mkdir -p "$tty" /sys/bus/pci/devices /sys/bus/usb/devices "/sys/bus/usb/drivers/$driver" "/sys/bus/usb-serial/drivers/$driver" \
  /sys/bus/usb-serial/devices /sys/class/tty /sys/kernel /sys/module

echo "DRIVER=xhci_hcd
PCI_SLOT_NAME=0000:00:14.0" >/sys/devices/pci0000:00/0000:00:14.0/uevent
ln -s /sys/bus/pci /sys/devices/pci0000:00/0000:00:14.0/subsystem

echo "MAJOR=189
MINOR=1
DEVNAME=bus/usb/001/002
DEVTYPE=usb_device
DRIVER=usb
PRODUCT=403/6001/600
TYPE=0/0/0" >$adapter/uevent
ln -s /sys/bus/usb $adapter/subsystem
echo 0403 >$adapter/idVendor
echo 6001 >$adapter/idProduct
echo FTDI >$adapter/manufacturer
echo "USB-RS485 Cable" >$adapter/product
[ -z "$serial" ] || echo "$serial" >$adapter/serial

echo "DEVTYPE=usb_interface
DRIVER=$driver
INTERFACE=255/255/255" >$interface/uevent
ln -s /sys/bus/usb $interface/subsystem
ln -s "/sys/bus/usb/drivers/$driver" $interface/driver
echo 00 >$interface/bInterfaceNumber
echo ff >$interface/bInterfaceClass

echo "DRIVER=$driver" >$port/uevent
ln -s /sys/bus/usb-serial $port/subsystem
ln -s "/sys/bus/usb-serial/drivers/$driver" $port/driver
ln -s "$port" /sys/bus/usb-serial/devices/ttyUSB0
printf 9 >$port/latency_timer  # one digit: a write does not truncate the file

echo "MAJOR=188
MINOR=0
DEVNAME=ttyUSB0" >$tty/uevent
echo 188:0 >$tty/dev
ln -s /sys/class/tty $tty/subsystem
ln -s "$port" $tty/device
ln -s "$tty" /sys/class/tty/ttyUSB0
