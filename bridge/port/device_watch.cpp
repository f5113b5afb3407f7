#include "bridge/port/device_watch.hpp"

#include <limits.h>
#include <sys/epoll.h>
#include <sys/inotify.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <boost/asio/io_context.hpp>
#include <cerrno>
#include <cstdlib>
#include <deque>
#include <filesystem>
#include <system_error>
#include <thread>
#include <utility>

#include "bridge/base/file_descriptor.hpp"

namespace fieldcast {

namespace {

namespace asio = boost::asio;
namespace fs = std::filesystem;

constexpr int kMaxLinks = 40;  // limit of the kernel for one path (path_resolution(7))
constexpr std::uint32_t kEvents =
    IN_CREATE | IN_MOVED_TO | IN_ATTRIB | IN_DELETE | IN_MOVED_FROM | IN_ONLYDIR;

Duration since_epoch(const timespec& time) {
  return std::chrono::seconds{time.tv_sec} + std::chrono::nanoseconds{time.tv_nsec};
}

}  // namespace

std::vector<std::string> folders_on_the_way(const std::string& path) {
  std::vector<std::string> folders;
  std::error_code fault;
  const fs::path whole = fs::absolute(path, fault);
  std::deque<fs::path> rest(whole.begin(), whole.end());
  fs::path at = "/";
  for (int links = 0; !rest.empty() && !fault;) {
    const fs::path part = rest.front();
    rest.pop_front();
    if (part.empty() || part == "/" || part == ".") continue;
    if (part == "..") {
      at = at.parent_path();
      continue;
    }
    if (std::find(folders.begin(), folders.end(), at.string()) == folders.end())
      folders.push_back(at.string());
    const fs::path next = at / part;
    const auto status = fs::symlink_status(next, fault);
    if (fault || !fs::exists(status)) break;
    if (!fs::is_symlink(status)) {
      at = next;
      continue;
    }
    if (++links > kMaxLinks) break;
    const fs::path target = fs::read_symlink(next, fault);
    if (target.is_absolute()) at = "/";
    rest.insert(rest.begin(), target.begin(), target.end());
  }
  return folders;
}

std::optional<DeviceWatch::Identity> DeviceWatch::identity_of(const std::string& path) {
  struct stat file {};
  if (::stat(path.c_str(), &file) != 0) return std::nullopt;
  return Identity{file.st_dev,
                  file.st_rdev,
                  file.st_ino,
                  file.st_mode,
                  file.st_uid,
                  file.st_gid,
                  since_epoch(file.st_ctim)};
}

namespace {

// The kernel releases an inotify instance after a grace period (fsnotify_destroy_group), which was
// more than a second on a busy machine. A separate thread closes it, so that no bus waits.
void close_elsewhere(FileDescriptor watch) {
  try {
    std::thread([closed = std::move(watch)] {}).detach();
  } catch (const std::system_error&) {
    // No thread: the descriptor was closed by its destructor.
  }
}

}  // namespace

// The watch from start() to stop(). Handlers share ownership; once over_ is set they do nothing.
class DeviceWatch::Watching : public std::enable_shared_from_this<Watching> {
 public:
  Watching(asio::io_context& io, const std::string& path, const std::function<void()>& came,
           std::optional<Identity> last)
      : path_(path), came_(came), last_(last), stream_(io), timer_(io) {}

  void start() {
    const int fd = ::inotify_init1(IN_NONBLOCK | IN_CLOEXEC);
    if (fd >= 0) {
      stream_.assign(fd);
      watch_folders();
      listen();
    }
    check_in(kSettle);
  }

  void stop() {
    over_ = true;
    timer_.cancel();
    if (stream_.is_open()) close_elsewhere(FileDescriptor(stream_.release()));
  }

 private:
  // Repeated after each change, because folders appear and disappear. Existing watches stay.
  void watch_folders() {
    for (const std::string& folder : folders_on_the_way(path_))
      ::inotify_add_watch(stream_.native_handle(), folder.c_str(), kEvents);
  }

  void listen() {
    stream_.async_wait(
        asio::posix::stream_descriptor::wait_read,
        [self = shared_from_this()](boost::system::error_code fault) {
          if (self->over_ || fault) return;
          std::array<char, 4096> events;  // the contents are not needed
          while (::read(self->stream_.native_handle(), events.data(), events.size()) > 0) {}
          self->watch_folders();
          self->check_in(kSettle);
          self->listen();
        });
  }

  // Later events do not delay the check: a folder may change permanently.
  void check_in(Duration wait) {
    if (std::exchange(checking_, true)) return;
    timer_.expires_after(wait);
    timer_.async_wait([self = shared_from_this()](boost::system::error_code cancelled) {
      if (self->over_ || cancelled) return;
      self->checking_ = false;
      if (!self->stream_.is_open()) self->check_in(kCheckPeriod);
      self->check();
    });
  }

  void check() {
    const auto found = identity_of(path_);
    if (!found) last_.reset();
    if (!found || found == last_) return;
    last_ = found;
    came_();
  }

  const std::string path_;
  const std::function<void()> came_;
  std::optional<Identity> last_;
  asio::posix::stream_descriptor stream_;
  asio::steady_timer timer_;
  bool checking_ = false;
  bool over_ = false;
};

DeviceWatch::DeviceWatch(asio::io_context& io, std::string path, std::function<void()> came)
    : io_(io), path_(std::move(path)), came_(std::move(came)) {}

DeviceWatch::~DeviceWatch() { stop(); }

void DeviceWatch::start(std::optional<Identity> last) {
  if (watching_) return;
  watching_ = std::make_shared<Watching>(io_, path_, came_, last);
  watching_->start();
}

void DeviceWatch::stop() {
  if (!watching_) return;
  watching_->stop();
  watching_.reset();
}

namespace asio = boost::asio;

bool Readiness::assign(int fd) {
  const int epoll = ::epoll_create1(EPOLL_CLOEXEC);
  if (epoll < 0) return false;
  epoll_event nothing{};
  nothing.events = EPOLLONESHOT;
  boost::system::error_code fault;
  if (::epoll_ctl(epoll, EPOLL_CTL_ADD, fd, &nothing) == 0) watch_.assign(epoll, fault);
  if (fault || !watch_.is_open()) {
    ::close(epoll);
    return false;
  }
  fd_ = fd;
  return true;
}

void Readiness::close() {
  if (!watch_.is_open()) return;
  // The descriptor or its copies may stay open elsewhere, which would keep it in the epoll.
  ::epoll_ctl(watch_.native_handle(), EPOLL_CTL_DEL, fd_, nullptr);
  readable_ = writable_ = {};
  boost::system::error_code ignored;
  watch_.close(ignored);
}

void Readiness::wait(Handler& slot, Handler handler) {
  if (!is_open()) return;
  slot = std::move(handler);
  arm();
}

void Readiness::arm() {
  epoll_event wanted{};
  wanted.events =
      EPOLLONESHOT | (readable_ ? EPOLLIN | EPOLLRDHUP : 0u) | (writable_ ? EPOLLOUT : 0u);
  ::epoll_ctl(watch_.native_handle(), EPOLL_CTL_MOD, fd_, &wanted);
  if (std::exchange(waiting_, true)) return;
  watch_.async_wait(asio::posix::stream_descriptor::wait_read,
                    [this, alive = std::weak_ptr<int>(alive_)](boost::system::error_code fault) {
                      if (alive.lock()) on_event(fault);
                    });
}

// A handler may close this object and destroy its owner: no member is used after the last handler.
void Readiness::on_event(boost::system::error_code fault) {
  waiting_ = false;
  if (!is_open()) return;
  epoll_event event{};
  if (!fault) ::epoll_wait(watch_.native_handle(), &event, 1, 0);
  const bool broken = fault || (event.events & (EPOLLERR | EPOLLHUP)) != 0;
  Handler readable, writable;
  if (broken || (event.events & (EPOLLIN | EPOLLRDHUP)) != 0)
    readable = std::exchange(readable_, {});
  if (broken || (event.events & EPOLLOUT) != 0) writable = std::exchange(writable_, {});
  if (readable_ || writable_) arm();
  if (readable) readable(fault);
  if (writable) writable(fault);
}

}  // namespace fieldcast
