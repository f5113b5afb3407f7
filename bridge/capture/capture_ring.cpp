#include "bridge/capture/capture_ring.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <ctime>
#include <filesystem>

#include "bridge/base/errno_text.hpp"
#include "bridge/log/log.hpp"

namespace fieldcast {
namespace {

constexpr std::string_view kEnding = ".pcapng";
constexpr std::string_view kTimeForm = "20261122T142421Z";
constexpr int kMostOfOneSecond = 1000;
constexpr std::size_t kTailBytes = 256;  // of the block at the end, at most

std::string time_name(UtcTime at) {
  const std::time_t seconds = at.nanoseconds / 1'000'000'000;
  std::tm parts{};
  ::gmtime_r(&seconds, &parts);
  return fmt::format("{:%Y%m%dT%H%M%SZ}", parts);
}

bool has_time_form(std::string_view text) {
  if (text.size() != kTimeForm.size()) return false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool digit = text[i] >= '0' && text[i] <= '9';
    const bool digit_wanted = kTimeForm[i] >= '0' && kTimeForm[i] <= '9';
    if (digit != digit_wanted || (!digit && text[i] != kTimeForm[i])) return false;
  }
  return true;
}

// The text behind the bus: "20261122T142421Z" or "20261122T142421Z-0002".
bool is_ring_name(std::string_view rest) {
  if (!has_time_form(rest.substr(0, kTimeForm.size()))) return false;
  rest.remove_prefix(kTimeForm.size());
  return rest.empty() || (rest.size() == 5 && rest[0] == '-' &&
                          rest.find_first_not_of("0123456789", 1) == rest.npos);
}

// Nothing: there is. Else why the folder takes no more.
std::optional<std::string> lack_of(const std::string& folder, std::uint64_t wanted) {
  struct statvfs disk {};
  if (::statvfs(folder.c_str(), &disk) != 0) return folder + ": " + errno_text(errno);
  const std::uint64_t left = static_cast<std::uint64_t>(disk.f_bavail) * disk.f_frsize;
  if (left >= wanted) return std::nullopt;
  return fmt::format("{}: the disk is nearly full, {} MB are left", folder, left / 1'000'000);
}

}  // namespace

std::vector<std::string> ring_files(const std::string& bus, std::vector<std::string> names) {
  std::erase_if(names, [&](const std::string& name) {
    std::string_view rest = name;
    if (!rest.starts_with(bus + "-") || !rest.ends_with(kEnding)) return true;
    rest.remove_prefix(bus.size() + 1);
    rest.remove_suffix(kEnding.size());
    return !is_ring_name(rest);
  });
  // Without the ending, a name sorts before the same one with a number.
  std::ranges::sort(names, {}, [](const std::string& name) {
    return name.substr(0, name.size() - kEnding.size());
  });
  return names;
}

CaptureRing::CaptureRing(std::string bus, CaptureSpec spec,
                         std::function<Bytes(const std::string&)> head)
    : bus_(std::move(bus)), spec_(std::move(spec)), head_(std::move(head)) {
  if (const auto lack = lack_of(spec_.folder, kLeastFree)) stop(*lack);
}

CaptureRing::~CaptureRing() { end("the capture ended"); }

void CaptureRing::packet(ByteView block, UtcTime at) {
  if (stopped_) {
    ++missed_;
    return;
  }
  if (file_ && file_->size() + block.size() + kTailBytes > spec_.file_bytes) end({});
  if (!file_ && !begin(at)) {
    ++missed_;
    return;
  }
  if (const auto written = file_->append(block); !written) {
    ++missed_;
    return stop(written.error().text);
  }
  ++counts_.frames;
  counts_.ended = at;
}

void CaptureRing::lost(std::uint64_t records) { (file_ ? counts_.dropped : missed_) += records; }

void CaptureRing::look(UtcTime now) {
  if (now.nanoseconds - looked_.nanoseconds < kLook.count() && now >= looked_) return;
  looked_ = now;
  const auto lack = lack_of(spec_.folder, stopped_ ? 2 * kLeastFree : kLeastFree);
  if (lack && !stopped_) return stop(*lack);
  if (lack || !stopped_) return;
  stopped_ = false;  // until the next frame shows it
}

bool CaptureRing::begin(UtcTime at) {
  const std::string name = fmt::format("{}/{}-{}", spec_.folder, bus_, time_name(at));
  auto made = CaptureFile::make(name + std::string(kEnding));
  for (int i = 2; !made && made.error().error == EEXIST && i < kMostOfOneSecond; ++i)
    made = CaptureFile::make(fmt::format("{}-{:04}{}", name, i, kEnding));
  if (!made) {
    stop(made.error().text);
    return false;
  }
  const std::string remark =
      missed_ == 0 ? "" : fmt::format("{} frames are missing before this file", missed_);
  const Bytes head = head_(remark);
  if (const auto written = made->append(head); !written) {
    ::unlink(made->path().c_str());
    stop(written.error().text);
    return false;
  }
  if (!told_.empty())
    log_info(bus_,
             fmt::format("capture: goes on in {}; {} frames are missing", spec_.folder, missed_));
  told_.clear();
  missed_ = 0;
  counts_ = {.begun = at, .ended = at};
  file_.emplace(*std::move(made));
  remove_oldest();
  return true;
}

void CaptureRing::end(const std::string& why) {
  if (!file_) return;
  (void)file_->append(capture_tail(counts_, why));  // a file without it is whole, too
  file_.reset();
}

void CaptureRing::stop(const std::string& why) {
  end("stopped: " + why);
  stopped_ = true;
  if (std::exchange(told_, why) == why) return;
  log_warning(bus_, fmt::format("capture: stopped: {}; the bus goes on, and the capture when there "
                                "is room",
                                why));
}

void CaptureRing::remove_oldest() const {
  std::vector<std::string> names;
  std::error_code error;
  for (std::filesystem::directory_iterator each(spec_.folder, error), end; !error && each != end;
       each.increment(error))
    names.push_back(each->path().filename().string());
  names = ring_files(bus_, std::move(names));
  for (std::size_t i = 0; i + spec_.files < names.size(); ++i)
    ::unlink((spec_.folder + "/" + names[i]).c_str());
}

}  // namespace fieldcast
