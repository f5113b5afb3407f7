// A writer that a new one replaces after many messages. When a reader of Fast DDS matches a writer,
// it counts one by one up to the first message that it can get (0.2 to 0.5 us each,
// StatefulReader::NotifyChanges), and takes no message meanwhile: after a year with 25 messages a
// second, a new station would wait for minutes. For topics whose values are repeated, or sent again
// to each new reader. Any thread.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <shared_mutex>

#include "bridge/dds/transport/domain.hpp"

namespace fieldcast {

class RenewedWriter {
 public:
  static constexpr std::uint64_t kMostMessages = 1 << 16;
  // The next writer matches its readers before its first message, and the former one repairs its
  // last messages.
  static constexpr Duration kOverlap = std::chrono::seconds{3};

  using Make = std::function<dds::DataWriter*(dds::DataWriterListener*, dds::StatusMask)>;
  // `matched` is called on a DDS thread for each new reader; may be null. Throws DdsError.
  RenewedWriter(Domain& domain, Make make, std::function<void()> matched = nullptr,
                std::uint64_t most = kMostMessages);
  ~RenewedWriter();
  RenewedWriter(const RenewedWriter&) = delete;
  RenewedWriter& operator=(const RenewedWriter&) = delete;

  void write(void* message);
  void unregister(void* message);
  [[nodiscard]] std::uint32_t readers() const;

  // Call it regularly: each call does the next step of a replacement that is due. Does not throw;
  // the writer stays if the library creates no other.
  void tidy(Instant now);

 private:
  struct Entity;
  std::unique_ptr<Entity> make_entity();

  Domain& domain_;
  const Make make_;
  const std::function<void()> matched_;
  const std::uint64_t most_;
  std::mutex tidying_;
  Instant since_{};                  // of the last step
  mutable std::shared_mutex mutex_;  // shared to write, exclusive to replace; protects the entities
  std::unique_ptr<Entity> current_, next_, former_;
  std::atomic<std::uint64_t> written_{0};  // by the current one
};

}  // namespace fieldcast
