// Tells when the file of a device appears, or changes: an adapter that was unplugged is back.
// Watches (inotify(7)) every folder on the way to the file, those that its links lead through too,
// since /dev/serial/by-id goes with its last adapter and comes with the next. Lives on its bus's io
// thread.
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
  // What a file is; another one after the adapter was plugged in anew, or udev gave it to a group.
  struct Identity {
    dev_t device = 0, number = 0;
    ino_t inode = 0;
    mode_t mode = 0;
    uid_t user = 0;
    gid_t group = 0;
    Duration changed{};  // of its inode
    friend bool operator==(const Identity&, const Identity&) = default;
  };
  // Through links; nothing where there is no file.
  [[nodiscard]] static std::optional<Identity> identity_of(const std::string& path);

  // udev makes a file, its links and its rights one after the other: the file is checked so long
  // after a change.
  static constexpr Duration kSettle = std::chrono::milliseconds{20};
  // Without inotify (the user's instances are used up) the file is checked this often.
  static constexpr Duration kCheckPeriod = std::chrono::milliseconds{500};

  DeviceWatch(boost::asio::io_context& io, std::string path, std::function<void()> came);
  ~DeviceWatch();
  DeviceWatch(const DeviceWatch&) = delete;
  DeviceWatch& operator=(const DeviceWatch&) = delete;

  // Calls `came` whenever there is a file that differs from `last`, and from the one it was called
  // for before. Until stop(); not from inside.
  void start(std::optional<Identity> last);
  void stop();

 private:
  class Watching;
  boost::asio::io_context& io_;
  const std::string path_;
  const std::function<void()> came_;
  std::shared_ptr<Watching> watching_;  // shared with the handlers under way
};

// The folders in which the file, its links and what they lead to are named, as far as they exist.
[[nodiscard]] std::vector<std::string> folders_on_the_way(const std::string& path);

}  // namespace fieldcast
