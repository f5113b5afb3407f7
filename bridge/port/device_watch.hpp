// Watches a device file with inotify(7) and reports when it appears or is replaced, for example
// when a USB adapter is plugged in again. Watches every folder on the path to the file and to the
// targets of its links, because /dev/serial/by-id is removed with the last adapter. Lives on its
// bus's io thread.
#pragma once

#include <sys/stat.h>

#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/steady_timer.hpp>
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

}  // namespace fieldcast
