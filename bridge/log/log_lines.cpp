#include "bridge/log/log_lines.hpp"

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <string_view>
#include <utility>

#include "bridge/base/file_descriptor.hpp"
#include "bridge/log/log_output.hpp"

namespace fieldcast {

LineVerdict LineBudget::occurred(std::string_view kind, Instant now) {
  auto found = entries_.find(kind);
  if (found == entries_.end()) {
    std::erase_if(entries_, [&](const auto& each) {
      return each.second.suppressed == 0 && now - each.second.begun >= kPeriod;
    });
    if (entries_.size() >= kMaxKinds) kind = "others";
    found = entries_.try_emplace(std::string(kind), Entry{now}).first;
  }
  Entry& entry = found->second;
  std::uint64_t suppressed = 0;
  if (now - entry.begun >= kPeriod) {
    suppressed = entry.suppressed;
    entry = {now};
  }
  if (entry.lines == kLines) {
    ++entry.suppressed;
    return {};
  }
  ++entry.lines;
  return {true, suppressed};
}

std::vector<LineSummary> LineBudget::summaries(Instant now) {
  std::vector<LineSummary> due;
  for (auto& [kind, entry] : entries_) {
    if (entry.suppressed == 0 || now - entry.begun < kPeriod) continue;
    due.push_back({kind, entry.suppressed});
    entry = {now};
  }
  return due;
}

LineVerdict RepeatFilter::occurred(const std::string& key, Instant now) {
  const auto found = entries_.find(key);
  if (found == entries_.end()) {
    make_room();
    entries_.emplace(key, Entry{now, now});
    return {true, 0};
  }
  Entry& entry = found->second;
  entry.last_seen = now;
  if (now - entry.last_line < kSummary) {
    ++entry.suppressed;
    return {};
  }
  entry.last_line = now;
  return {true, std::exchange(entry.suppressed, 0)};
}

LineVerdict RepeatFilter::recovered(const std::string& key) {
  const auto found = entries_.find(key);
  if (found == entries_.end()) return {};
  const LineVerdict verdict{true, found->second.suppressed};
  entries_.erase(found);
  return verdict;
}

std::vector<LineSummary> RepeatFilter::summaries(Instant now) {
  std::vector<LineSummary> due;
  for (auto& [key, entry] : entries_) {
    if (entry.suppressed == 0 || now - entry.last_line < kSummary) continue;
    due.push_back({key, std::exchange(entry.suppressed, 0)});
    entry.last_line = now;
  }
  std::sort(due.begin(), due.end(),
            [](const LineSummary& a, const LineSummary& b) { return a.key < b.key; });
  return due;
}

void RepeatFilter::make_room() {
  if (entries_.size() < kMaxKeys) return;
  entries_.erase(std::min_element(
      entries_.begin(), entries_.end(),
      [](const auto& a, const auto& b) { return a.second.last_seen < b.second.last_seen; }));
}

struct LineWriter::State {
  FileDescriptor fd;    // owned by the thread
  FileDescriptor next;  // replaces `fd` before the next line; usually empty
  std::function<std::string(std::uint64_t)> remark;
  std::mutex mutex;
  std::condition_variable work, done;
  std::deque<std::string> waiting;
  std::size_t bytes = 0;
  std::uint64_t put = 0;
  std::uint64_t seen = 0;
  std::uint64_t lost = 0;
  std::uint64_t to_tell = 0;  // lost lines that are not in a remark yet
  bool ending = false;

  void run();
  // Returns the next lines that fit in one piece, after a remark about lines lost before them.
  std::string take(std::size_t& lines, std::uint64_t& told);
  [[nodiscard]] bool write(std::string_view text);
  [[nodiscard]] bool is_ending() {
    const std::lock_guard lock(mutex);
    return ending;
  }
};

void LineWriter::State::run() {
  std::unique_lock lock(mutex);
  while (true) {
    work.wait(lock, [this] { return ending || !waiting.empty(); });
    if (ending) return;
    if (next.valid()) fd = std::move(next);
    std::size_t lines = 0;
    std::uint64_t told = 0;
    const std::string text = take(lines, told);
    lock.unlock();
    const bool written = write(text);
    lock.lock();
    seen += lines;
    if (!written) {
      lost += lines;
      to_tell += told + lines;
    }
    done.notify_all();
  }
}

std::string LineWriter::State::take(std::size_t& lines, std::uint64_t& told) {
  std::string text;
  if (to_tell > 0) text = remark(told = std::exchange(to_tell, 0));
  do {
    text += waiting.front();
    bytes -= waiting.front().size();
    waiting.pop_front();
    ++lines;
  } while (!waiting.empty() && text.size() + waiting.front().size() <= kOutputPiece);
  return text;
}

bool LineWriter::State::write(std::string_view text) {
  while (!text.empty()) {
    const auto size = write_output(fd.get(), text);
    if (!size || (*size == 0 && is_ending())) return false;
    text.remove_prefix(*size);
  }
  return true;
}

LineWriter::LineWriter(int fd, std::function<std::string(std::uint64_t)> remark)
    : state_(std::make_shared<State>()) {
  state_->fd.reset(duplicate_output(fd));
  state_->remark = std::move(remark);
  start_output_thread([state = state_] { state->run(); });
}

LineWriter::~LineWriter() {
  {
    const std::lock_guard lock(state_->mutex);
    state_->ending = true;
  }
  state_->work.notify_one();
}

void LineWriter::reopen(int fd) {
  FileDescriptor next(duplicate_output(fd));
  const std::lock_guard lock(state_->mutex);
  state_->next = std::move(next);
}

void LineWriter::put(std::string line) {
  {
    State& s = *state_;
    const std::lock_guard lock(s.mutex);
    s.bytes += line.size();
    s.waiting.push_back(std::move(line));
    ++s.put;
    while (s.bytes > kMaxWaiting && s.waiting.size() > 1) {
      s.bytes -= s.waiting.front().size();
      s.waiting.pop_front();
      ++s.seen, ++s.lost, ++s.to_tell;
    }
  }
  state_->work.notify_one();
}

bool LineWriter::flush(Duration limit) {
  std::unique_lock lock(state_->mutex);
  const std::uint64_t wanted = state_->put;
  return state_->done.wait_for(lock, limit, [&] { return state_->seen >= wanted; });
}

std::uint64_t LineWriter::lost() const {
  const std::lock_guard lock(state_->mutex);
  return state_->lost;
}

}  // namespace fieldcast
