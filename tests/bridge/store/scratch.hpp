#pragma once

#include <mutex>
#include <string>
#include <vector>

#include "bridge/store/records/records.hpp"
#include "tests/bridge/security/scratch_folder.hpp"

namespace fieldcast::test {

using Scratch = ScratchFolder;

class RecordingAudit final : public Audit {
 public:
  void append(AuditEntry entry) override {
    const std::lock_guard lock(mutex_);
    entries_.push_back(std::move(entry));
  }
  [[nodiscard]] std::vector<AuditEntry> entries() const {
    const std::lock_guard lock(mutex_);
    return entries_;
  }
  // Returns each entry as "WHO | WHAT | TARGET | RESULT".
  [[nodiscard]] std::vector<std::string> rows() const {
    std::vector<std::string> rows;
    for (const AuditEntry& entry : entries())
      rows.push_back(entry.who + " | " + entry.what + " | " + entry.target + " | " + entry.result);
    return rows;
  }

 private:
  mutable std::mutex mutex_;
  std::vector<AuditEntry> entries_;
};

}  // namespace fieldcast::test
