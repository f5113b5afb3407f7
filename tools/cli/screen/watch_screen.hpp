// The screen of `fieldcast watch`: keys in, frames and intents out. Pure: no terminal, clock or
// DDS. Main thread; the models must outlive it. A write intent needs a confirmation of the old and
// new value; one write at a time.
#pragma once

#include <optional>
#include <string>
#include <variant>

#include "tools/cli/model/command_text.hpp"
#include "tools/cli/screen/channel_rows.hpp"
#include "tools/cli/screen/list_control.hpp"
#include "tools/cli/text/output.hpp"
#include "tools/cli/view/status/status_view.hpp"

namespace fieldcast::cli {

struct QuitIntent {};
struct WriteIntent {
  ChannelPath path;
  Value value;
  std::string type, unit;
  bool verify = false;
};
using Intent = std::variant<std::monostate, QuitIntent, WriteIntent>;

class WatchScreen {
 public:
  WatchScreen(const WatchModel& model, const StatusModel& status, bool unicode)
      : model_(model), status_(status), unicode_(unicode) {}

  void on_sample(const StationSample& sample);
  [[nodiscard]] Intent on_key(const Key& key, const Moment& moment);
  void on_outcome(const Outcome& outcome);
  // The notice is shown if there are no rows, the remark as a warning. Both may be empty.
  void set_notice(std::string notice) { notice_ = std::move(notice); }
  void set_remark(std::string remark) { remark_ = std::move(remark); }

  [[nodiscard]] Frame frame(const Moment& moment, const Screen& screen);

 private:
  static constexpr Duration kSortAgain = std::chrono::seconds{1};

  enum class Question : unsigned char { kNone, kValue, kConfirm };

  void rebuild(const Moment& moment);
  bool on_own_key(const Key& key);
  void ask_for_value();
  [[nodiscard]] Intent on_question_key(const Key& key);
  void take_value();
  [[nodiscard]] std::vector<FrameLine> pane(const Moment& moment, std::size_t columns) const;
  [[nodiscard]] std::string input_text() const;
  [[nodiscard]] std::vector<FrameLine> question_lines(const Moment& moment, std::size_t columns);
  [[nodiscard]] std::vector<FrameLine> channel_details(const ListRow& row, const Moment& moment,
                                                       std::size_t columns) const;
  [[nodiscard]] FrameLine title(const Moment& moment, std::size_t columns) const;
  [[nodiscard]] FrameLine state_line(std::size_t list_rows, std::size_t columns);
  [[nodiscard]] FrameLine group_line(const ListRow& row, std::size_t columns) const;

  const WatchModel& model_;
  const StatusModel& status_;
  const bool unicode_;
  ListControl control_;
  ChannelChoice choice_;
  ChannelRows sums_;  // without the rows, which the control stores
  TrendHistory trends_;
  std::optional<Instant> sorted_at_;
  std::string notice_, remark_;
  Span message_;

  Question question_ = Question::kNone;
  LineEdit typed_;
  std::string fault_;  // fault of the typed value
  WriteIntent write_;  // to be confirmed, or in flight
  bool waiting_ = false;
  std::size_t columns_ = 80;    // of the last frame
  std::size_t input_line_ = 0;  // line of the dialog where the value is typed
};

}  // namespace fieldcast::cli
