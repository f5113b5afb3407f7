// The thread that a bus lives on, with an io_context of its own. The context is the bus's strand:
// its handlers run one after another, on this thread only, and take no lock of another bus. A
// driver that hangs (a USB adapter that died in the middle of an ioctl) stops its own bus and no
// other.
#pragma once

#include <memory>
#include <string>

namespace boost::asio {
class io_context;
}

namespace fieldcast {

class IoThread {
 public:
  // `name` is shown by `top -H` and debuggers, cut to the kernel's 15 bytes.
  explicit IoThread(const std::string& name);
  ~IoThread();  // ends the thread; handlers still queued do not run
  IoThread(const IoThread&) = delete;
  IoThread& operator=(const IoThread&) = delete;

  [[nodiscard]] boost::asio::io_context& context();

 private:
  struct Loop;
  std::unique_ptr<Loop> loop_;
};

}  // namespace fieldcast
