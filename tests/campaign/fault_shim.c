// A library for LD_PRELOAD that makes the disk and the clock fail on demand, for one process.
//
// FAULT_FILE names a file with a struct Faults, which the campaign writes. The file is mapped, so
// changes take effect immediately. The library counts operations on files below FAULT_FOLDER there.
// As set in the struct, an operation fails, is slow or kills the process. CLOCK_REALTIME is moved
// by `clock_offset_ns`; waits until a time of this clock follow, also if it is set meanwhile. All
// other calls are unchanged. Any thread.
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

// Little-endian, 8 bytes each: tests/campaign/fault_shim.py writes it.
struct Faults {
  _Atomic int64_t operations;       // writes, syncs, truncations and removals so far
  _Atomic int64_t kill_at;          // the process is killed at this one; 0: never
  _Atomic int64_t kill_how;         // 0: before it, 1: after half of a write, 2: after it
  _Atomic int64_t error;            // errno of each of them; 0: none
  _Atomic int64_t delay_us;         // before each of them
  _Atomic int64_t clock_offset_ns;  // added to CLOCK_REALTIME
};

static struct Faults none;
static struct Faults* faults = &none;
static char folder[PATH_MAX];

__attribute__((constructor)) static void begin(void) {
  const char* file = getenv("FAULT_FILE");
  const char* below = getenv("FAULT_FOLDER");
  snprintf(folder, sizeof folder, "%s", below ? below : "/nowhere");
  const int fd = file ? open(file, O_RDWR | O_CLOEXEC) : -1;
  if (fd < 0) return;
  void* mapped = mmap(NULL, sizeof *faults, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
  close(fd);
  if (mapped != MAP_FAILED) faults = mapped;
}

#define REAL(name) ((__typeof__(&name))real(#name))
static void* real(const char* name) { return dlsym(RTLD_NEXT, name); }

static int path_is_ours(const char* path) { return strncmp(path, folder, strlen(folder)) == 0; }

static int is_ours(int fd) {
  char link[64], path[PATH_MAX];
  snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
  const ssize_t size = readlink(link, path, sizeof path - 1);
  if (size <= 0) return 0;
  path[size] = 0;
  return path_is_ours(path);
}

static void die(void) {
  kill(getpid(), SIGKILL);
  for (;;) pause();
}

// Returns 0 if the operation must be executed, else its errno. Kills the process before it if
// `kill_at` and `kill_how` request that.
static int strike(int64_t* number) {
  *number = atomic_fetch_add(&faults->operations, 1) + 1;
  const int64_t delay = atomic_load(&faults->delay_us);
  if (delay > 0) {
    const struct timespec rest = {delay / 1000000, delay % 1000000 * 1000};
    nanosleep(&rest, NULL);
  }
  if (*number == atomic_load(&faults->kill_at) && atomic_load(&faults->kill_how) == 0) die();
  return (int)atomic_load(&faults->error);
}

static int is_last(int64_t number, int64_t how) {
  return number == atomic_load(&faults->kill_at) && atomic_load(&faults->kill_how) == how;
}

static ssize_t ended(int64_t number, ssize_t result) {
  if (is_last(number, 2) || is_last(number, 1)) die();
  return result;
}

#define OR_FAIL(number)                      \
  int64_t number = 0;                        \
  const int failure_of_it = strike(&number); \
  if (failure_of_it) return errno = failure_of_it, -1

ssize_t write(int fd, const void* bytes, size_t size) {
  if (!is_ours(fd)) return REAL(write)(fd, bytes, size);
  OR_FAIL(number);
  return ended(number, REAL(write)(fd, bytes, is_last(number, 1) ? size / 2 : size));
}

ssize_t pwrite(int fd, const void* bytes, size_t size, off_t at) {
  if (!is_ours(fd)) return REAL(pwrite)(fd, bytes, size, at);
  OR_FAIL(number);
  return ended(number, REAL(pwrite)(fd, bytes, is_last(number, 1) ? size / 2 : size, at));
}

ssize_t pwrite64(int fd, const void* bytes, size_t size, off64_t at) {
  if (!is_ours(fd)) return REAL(pwrite64)(fd, bytes, size, at);
  OR_FAIL(number);
  return ended(number, REAL(pwrite64)(fd, bytes, is_last(number, 1) ? size / 2 : size, at));
}

int fsync(int fd) {
  if (!is_ours(fd)) return REAL(fsync)(fd);
  OR_FAIL(number);
  return (int)ended(number, REAL(fsync)(fd));
}

int fdatasync(int fd) {
  if (!is_ours(fd)) return REAL(fdatasync)(fd);
  OR_FAIL(number);
  return (int)ended(number, REAL(fdatasync)(fd));
}

int ftruncate(int fd, off_t size) {
  if (!is_ours(fd)) return REAL(ftruncate)(fd, size);
  OR_FAIL(number);
  return (int)ended(number, REAL(ftruncate)(fd, size));
}

int ftruncate64(int fd, off64_t size) {
  if (!is_ours(fd)) return REAL(ftruncate64)(fd, size);
  OR_FAIL(number);
  return (int)ended(number, REAL(ftruncate64)(fd, size));
}

int unlink(const char* path) {
  if (!path_is_ours(path)) return REAL(unlink)(path);
  OR_FAIL(number);
  return (int)ended(number, REAL(unlink)(path));
}

static void move(struct timespec* time) {
  const int64_t offset = atomic_load(&faults->clock_offset_ns);
  if (offset == 0) return;
  const int64_t sum = time->tv_sec * INT64_C(1000000000) + time->tv_nsec + offset;
  time->tv_sec = sum / 1000000000;
  time->tv_nsec = sum % 1000000000;
}

int clock_gettime(clockid_t clock, struct timespec* time) {
  const int result = REAL(clock_gettime)(clock, time);
  if (result == 0 && clock == CLOCK_REALTIME) move(time);
  return result;
}

int gettimeofday(struct timeval* restrict when, void* restrict zone) {
  (void)zone;
  struct timespec now;
  clock_gettime(CLOCK_REALTIME, &now);
  when->tv_sec = now.tv_sec;
  when->tv_usec = now.tv_nsec / 1000;
  return 0;
}

time_t time(time_t* when) {
  struct timespec now;
  clock_gettime(CLOCK_REALTIME, &now);
  if (when) *when = now.tv_sec;
  return now.tv_sec;
}

// A time after 2001 is of the wall clock: the monotonic clock begins at the start of the machine.
static int is_wall_time(const struct timespec* time) { return time->tv_sec > 1000000000; }

static int is_before(const struct timespec* a, const struct timespec* b) {
  return a->tv_sec < b->tv_sec || (a->tv_sec == b->tv_sec && a->tv_nsec < b->tv_nsec);
}

typedef int Wait(pthread_cond_t*, pthread_mutex_t*, const struct timespec*);

// Returns early, as a spurious wakeup, so that the caller computes its wait again after a step.
static int wait_until(Wait* wait, pthread_cond_t* condition, pthread_mutex_t* mutex,
                      const struct timespec* deadline) {
  struct timespec now, slice;
  clock_gettime(CLOCK_REALTIME, &now);
  if (!is_before(&now, deadline)) return wait(condition, mutex, &(struct timespec){0, 0});
  REAL(clock_gettime)(CLOCK_REALTIME, &slice);
  slice.tv_nsec += 50000000;
  if (slice.tv_nsec >= 1000000000) {
    slice.tv_nsec -= 1000000000;
    ++slice.tv_sec;
  }
  const int result = wait(condition, mutex, &slice);
  return result == ETIMEDOUT ? 0 : result;
}

// Without a version, dlsym() may return the function for programs of before 2003.
static Wait* real_wait(void) {
  void* wait = dlvsym(RTLD_NEXT, "pthread_cond_timedwait", "GLIBC_2.3.2");
  return (Wait*)(wait ? wait : real("pthread_cond_timedwait"));
}

int pthread_cond_timedwait(pthread_cond_t* restrict condition, pthread_mutex_t* restrict mutex,
                           const struct timespec* restrict deadline) {
  if (faults == &none || !is_wall_time(deadline)) return real_wait()(condition, mutex, deadline);
  return wait_until(real_wait(), condition, mutex, deadline);
}
