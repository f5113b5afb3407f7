// Watches a device file with inotify(7) and reports when it appears or is replaced, as a USB
// adapter. Watches every folder on the path and of its links, because /dev/serial/by-id is removed
// with the last adapter. On its bus's io thread.
#pragma once

#include <sys/stat.h>

#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/steady_timer.hpp>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/time.hpp"

namespace fieldcast {

class DeviceWatch {
 public:
  // Identity of a file. Differs after a new plug-in, or after udev changed owner or mode.
  struct Identity {
    dev_t device = 0, number = 0;
    ino_t inode = 0;
    mode_t mode = 0;
    uid_t user = 0;
    gid_t group = 0;
    Duration changed{};  // change time of its inode
    friend bool operator==(const Identity&, const Identity&) = default;
  };
  // Follows links. Returns `std::nullopt` if there is no file.
  [[nodiscard]] static std::optional<Identity> identity_of(const std::string& path);

  // Delay after a change: udev creates a file, its links and its access rights one by one.
  static constexpr Duration kSettle = std::chrono::milliseconds{20};
  // Period of the check without inotify (the user's limit of instances is reached).
  static constexpr Duration kCheckPeriod = std::chrono::milliseconds{500};

  DeviceWatch(boost::asio::io_context& io, std::string path, std::function<void()> came);
  ~DeviceWatch();
  DeviceWatch(const DeviceWatch&) = delete;
  DeviceWatch& operator=(const DeviceWatch&) = delete;

  // Calls `came` each time the file exists and differs from `last` and from the file of the
  // previous call. Ends with stop(). `came` is never called inside start().
  void start(std::optional<Identity> last);
  void stop();

 private:
  class Watching;
  boost::asio::io_context& io_;
  const std::string path_;
  const std::function<void()> came_;
  std::shared_ptr<Watching> watching_;  // shared with pending handlers
};

// Returns the existing folders that contain the file, its links and their targets.
[[nodiscard]] std::vector<std::string> folders_on_the_way(const std::string& path);

// Waits until a descriptor is readable or writable; causes no wake-up while no wait is pending.
// Asio watches a terminal edge-triggered and wakes the thread for each burst of bytes. This class
// has its own epoll, armed for one event at a time. Owns the epoll, not the descriptor. On its
// bus's io thread.
class Readiness {
 public:
  using Handler = std::function<void(boost::system::error_code)>;

  explicit Readiness(boost::asio::io_context& io) : watch_(io) {}

  // Watches this descriptor until close(); call once. Returns false if that is not possible.
  [[nodiscard]] bool assign(int fd);
  [[nodiscard]] bool is_open() const { return watch_.is_open(); }
  [[nodiscard]] auto get_executor() { return watch_.get_executor(); }

  // Calls the handler once, posted, and not after close(). One wait of each kind at a time.
  void wait_readable(Handler handler) { wait(readable_, std::move(handler)); }
  void wait_writable(Handler handler) { wait(writable_, std::move(handler)); }
  void close();

 private:
  void wait(Handler& slot, Handler handler);
  void arm();
  void on_event(boost::system::error_code fault);

  int fd_ = -1;
  boost::asio::posix::stream_descriptor watch_;  // the epoll
  Handler readable_, writable_;
  bool waiting_ = false;  // for the epoll
  // The wait for the epoll may outlive this object.
  std::shared_ptr<int> alive_ = std::make_shared<int>();
};

}  // namespace fieldcast
