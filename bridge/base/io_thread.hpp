// Thread of one bus with its own io_context, whose handlers take no lock of another bus. A driver
// that hangs (for example an ioctl of a failed USB adapter) therefore stops only its own bus.
#pragma once

#include <functional>
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
  ~IoThread();  // ends the thread; queued handlers do not run
  IoThread(const IoThread&) = delete;
  IoThread& operator=(const IoThread&) = delete;

  [[nodiscard]] boost::asio::io_context& context();
  // For objects that use the context and may be destroyed after this one.
  [[nodiscard]] std::shared_ptr<boost::asio::io_context> shared_context();
  // Runs the task on the thread and waits for it; rethrows its exception. REQUIRES: another thread.
  void run(std::function<void()> task);

 private:
  struct Loop;
  std::unique_ptr<Loop> loop_;
};

}  // namespace fieldcast
