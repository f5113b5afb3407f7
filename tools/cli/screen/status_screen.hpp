// The screen of `fieldcast status`: keys in, frames out. Pure: no terminal, clock or DDS. Main
// thread; the model must outlive it.
#pragma once

#include <optional>
#include <string>

#include "tools/cli/screen/list_control.hpp"
#include "tools/cli/text/output.hpp"
#include "tools/cli/view/status/status_facts.hpp"

namespace fieldcast::cli {

class StatusScreen {
 public:
  explicit StatusScreen(const StatusModel& model) : model_(model) {}

  // Returns false if the user quits.
  [[nodiscard]] bool on_key(const Key& key, const Moment& moment);
  // Shown if there are no rows.
  void set_notice(std::string notice) { notice_ = std::move(notice); }
  [[nodiscard]] Frame frame(const Moment& moment, const Screen& screen);

 private:
  static constexpr Duration kSortAgain = std::chrono::seconds{1};

  void rebuild(const Moment& moment);
  [[nodiscard]] FrameLine title(const Moment& moment, std::size_t columns) const;
  [[nodiscard]] FrameLine row_line(const ListRow& row, std::size_t columns) const;

  const StatusModel& model_;
  ListControl control_;
  bool by_name_ = false;  // false: bad first
  bool bad_only_ = false;
  std::optional<Instant> sorted_at_;
  std::size_t known_ = 0;  // number of buses, devices and members in the current rows
  std::string notice_;
};

}  // namespace fieldcast::cli
