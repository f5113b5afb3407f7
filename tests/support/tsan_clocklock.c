// Replaces pthread_mutex_clocklock() of the C library in programs with the thread sanitizer,
// because the sanitizer of GCC 12 does not intercept it. Fast DDS locks with a timeout by this
// function: the sanitizer would report unlocks of unlocked mutexes and wrong lock orders, and would
// not know what these mutexes protect. pthread_mutex_timedlock() is intercepted.
#include <pthread.h>
#include <time.h>

enum { kNanoseconds = 1000000000 };

// Returns a + sign * b.
static struct timespec plus(struct timespec a, struct timespec b, long sign) {
  struct timespec sum = {a.tv_sec + sign * b.tv_sec, a.tv_nsec + sign * b.tv_nsec};
  if (sum.tv_nsec >= kNanoseconds) {
    ++sum.tv_sec;
    sum.tv_nsec -= kNanoseconds;
  } else if (sum.tv_nsec < 0) {
    --sum.tv_sec;
    sum.tv_nsec += kNanoseconds;
  }
  return sum;
}

int pthread_mutex_clocklock(pthread_mutex_t* mutex, clockid_t clock, const struct timespec* until) {
  struct timespec now, wall;
  clock_gettime(clock, &now);
  clock_gettime(CLOCK_REALTIME, &wall);
  const struct timespec wall_until = plus(wall, plus(*until, now, -1), 1);
  return pthread_mutex_timedlock(mutex, &wall_until);
}
