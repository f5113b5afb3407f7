#include "bridge/dds/library/library.hpp"

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <fastdds/dds/log/Log.hpp>
#include <memory>
#include <mutex>
#include <string_view>
#include <utility>

#include "bridge/dds/library/encoding_guard.hpp"
#include "bridge/dds/library/fastdds.hpp"
#include "bridge/dds/library/secured_announcement.hpp"

namespace fieldcast {

namespace {

using dds::Log;

// Fast DDS 2.9.1 prints this when an instance with a deadline is unregistered (DataWriterImpl),
// which happens for every channel that moves to another writer.
constexpr std::string_view kHarmless = "Could not set the next deadline in the history";

std::atomic<LibraryLines> elsewhere{nullptr};

std::mutex removed_mutex;
std::function<void()> removed_handler;

class PlainLines : public dds::LogConsumer {
 public:
  void Consume(const Log::Entry& entry) override {
    if (entry.message == kHarmless) return;
    if (const LibraryLines lines = elsewhere) {
      return lines(entry.kind == Log::Error, entry.context.category, entry.message);
    }
    std::fprintf(stderr, "Fast DDS %s: %s (%s)\n", entry.kind == Log::Error ? "error" : "warning",
                 entry.message.c_str(), entry.context.category);
  }
};

}  // namespace

void set_library_lines(LibraryLines lines) { elsewhere = lines; }

void say_security(bool error, std::string_view text) {
  if (const LibraryLines lines = elsewhere) return lines(error, kSecurityLine, text);
  std::fprintf(stderr, "security: %.*s\n", static_cast<int>(text.size()), text.data());
}

void on_removed(std::function<void()> handler) {
  const std::lock_guard lock(removed_mutex);
  removed_handler = std::move(handler);
}

void report_removed() {
  const std::lock_guard lock(removed_mutex);
  if (removed_handler) removed_handler();
}

void prepare_library() {
  static std::once_flag once;
  std::call_once(once, [] {
    guard_encoding();
    offer_secured_announcements();
    Log::ClearConsumers();
    Log::RegisterConsumer(std::make_unique<PlainLines>());
    // For diagnosis in the field: adds the library's warnings to its errors.
    // NOLINTNEXTLINE(concurrency-mt-unsafe): nothing sets the environment
    if (std::getenv("FIELDCAST_DDS_WARNINGS") != nullptr) Log::SetVerbosity(Log::Warning);
    turn_off_intraprocess_delivery();
  });
}

}  // namespace fieldcast
