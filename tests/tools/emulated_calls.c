// System calls that qemu-user 7.2 refuses, for tests of another processor: preload it.
// IP_MULTICAST_IF selects the interface of multicast; the test gives its only interface the route.
// TCGETS2 and TCSETS2 set any baud rate, which a pseudo-terminal ignores.
#define _GNU_SOURCE
#include <asm/ioctls.h>
#include <asm/termbits.h>
#include <dlfcn.h>
#include <netinet/in.h>
#include <stdarg.h>
#include <stddef.h>
#include <sys/socket.h>

int setsockopt(int fd, int level, int name, const void* value, socklen_t size) {
  static int (*next)(int, int, int, const void*, socklen_t);
  if (!next) next = (int (*)(int, int, int, const void*, socklen_t))dlsym(RTLD_NEXT, "setsockopt");
  if (level == IPPROTO_IP && name == IP_MULTICAST_IF) return 0;
  return next(fd, level, name, value, size);
}

static speed_t speeds[1024];  // of the descriptors of this process

int ioctl(int fd, unsigned long request, ...) {
  static int (*next)(int, unsigned long, ...);
  if (!next) next = (int (*)(int, unsigned long, ...))dlsym(RTLD_NEXT, "ioctl");
  va_list more;
  va_start(more, request);
  struct termios2* settings = va_arg(more, void*);
  va_end(more);
  if (fd < 0 || fd >= 1024) return next(fd, request, settings);
  // struct termios is the first part of struct termios2.
  if (request == TCGETS2) {
    const int result = next(fd, TCGETS, settings);
    if (result == 0 && speeds[fd] != 0) settings->c_cflag = (settings->c_cflag & ~CBAUD) | BOTHER;
    if (result == 0) settings->c_ispeed = settings->c_ospeed = speeds[fd];
    return result;
  }
  if (request == TCSETS2) {
    struct termios2 changed = *settings;
    speeds[fd] = changed.c_ospeed;
    changed.c_cflag = (changed.c_cflag & ~CBAUD) | B38400;
    return next(fd, TCSETS, &changed);
  }
  return next(fd, request, settings);
}
