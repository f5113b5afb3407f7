// Logs the notices of a bus: each fault once, then a summary every ten minutes and at its end.
// Owned by one BusRunner, on its io thread.
#pragma once

#include <string>
#include <string_view>

#include "bridge/log/log.hpp"
#include "bridge/log/log_lines.hpp"
#include "core/bus/setup/event.hpp"

namespace fieldcast {

class NoticeLog {
 public:
  explicit NoticeLog(std::string bus) : bus_(std::move(bus)) {}

  void notice(const Notice& notice, Instant now);
  void port_opened();
  void port_closed(const std::string& reason, Instant now);
  // Writes the summaries of counted lines; call once a second.
  void tick(Instant now);

 private:
  void fault(const std::string& key, const std::string& subject, const std::string& text,
             Instant now);
  void over(const std::string& key, const std::string& subject, const std::string& text);

  std::string bus_;
  RepeatFilter filter_;
  bool port_was_closed_ = false;
  std::string port_reason_;  // of the last closing
};

}  // namespace fieldcast
