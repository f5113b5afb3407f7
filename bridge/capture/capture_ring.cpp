#include "bridge/capture/capture_ring.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>

#include "bridge/base/file_descriptor.hpp"
#include "bridge/capture/capture_folder.hpp"
#include "bridge/log/log.hpp"

namespace fieldcast {

namespace {

CaptureFile::Fault fault_of(const std::string& path, int error) {
  return {error, path + ": " + errno_text(error)};
}

}  // namespace

tl::expected<CaptureFile, CaptureFile::Fault> CaptureFile::make(const std::string& path) {
  FileDescriptor file(
      ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0600));
  if (!file.valid()) return tl::unexpected(fault_of(path, errno));
  return CaptureFile(path, std::move(file));
}

tl::expected<void, CaptureFile::Fault> CaptureFile::append(ByteView blocks) {
  std::size_t written = 0;
  while (written < blocks.size()) {
    const auto wrote = ::write(file_.get(), blocks.data() + written, blocks.size() - written);
    if (wrote < 0 && errno == EINTR) continue;
    if (wrote <= 0) {
      const int error = wrote < 0 ? errno : ENOSPC;
      const auto end = static_cast<off_t>(size_);
      // Without the cut, the next block is written over the part of this one.
      [[maybe_unused]] const int cut = ::ftruncate(file_.get(), end);
      (void)::lseek(file_.get(), end, SEEK_SET);
      return tl::unexpected(fault_of(path_, error));
    }
    written += static_cast<std::size_t>(wrote);
  }
  size_ += blocks.size();
  return {};
}

bool CaptureFile::removed() const {
  struct stat about {};
  return ::fstat(file_.get(), &about) == 0 && about.st_nlink == 0;
}

namespace {

constexpr int kMostOfOneSecond = 1000;
constexpr std::size_t kTailBytes = 256;  // upper limit of the last block

// Returns why the folder cannot take `wanted` more bytes, or `std::nullopt` if it can.
std::optional<std::string> lack_of(const std::string& folder, std::uint64_t wanted) {
  const auto left = free_bytes_at(folder);
  if (!left) return left.error();
  if (*left >= wanted) return std::nullopt;
  return fmt::format("{}: the disk is nearly full, {} MB are left", folder, *left / 1'000'000);
}

}  // namespace

CaptureRing::CaptureRing(std::string bus, CaptureSpec spec,
                         std::function<Bytes(const std::string&)> head)
    : bus_(std::move(bus)), spec_(std::move(spec)), head_(std::move(head)) {
  if (const auto lack = lack_of(spec_.folder, kLeastFree)) stop(*lack);
}

CaptureRing::~CaptureRing() { end("the capture ended"); }

void CaptureRing::packet(ByteView block, UtcTime at, bool session) {
  if (spec_.only_sessions && !session) return;
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
  if (file_ && file_->removed()) end({});
  if (lack || !stopped_) return;
  stopped_ = false;  // the next frame tries again
}

bool CaptureRing::begin(UtcTime at) {
  const auto make = [&] {
    return CaptureFile::make(spec_.folder + "/" + ring_file_name(bus_, at, number_));
  };
  // A used name is not used again, also if its file was deleted.
  const std::int64_t second = at.nanoseconds / 1'000'000'000;
  number_ = std::exchange(second_, second) == second ? number_ + 1 : 1;
  auto made = make();
  for (; !made && made.error().error == EEXIST && number_ < kMostOfOneSecond; made = make())
    ++number_;
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
  (void)file_->append(capture_tail(counts_, why));  // a file without this block is also complete
  file_.reset();
}

void CaptureRing::stop(const std::string& why) {
  end("stopped: " + why);
  stopped_ = true;
  if (std::exchange(told_, why) == why) return;
  log_warning(
      bus_, fmt::format("capture: stopped: {}; the bus goes on, and the capture when it can", why));
}

// The newest file is the one begun now. If the clock was set back (a machine without a clock
// battery), files with later times are nevertheless older.
void CaptureRing::remove_oldest() const {
  std::vector<std::string> names = ring_files_in(spec_.folder, bus_);
  const auto newest =
      std::ranges::find(names, std::filesystem::path(file_->path()).filename().string());
  if (newest != names.end()) std::rotate(names.begin(), newest + 1, names.end());
  for (std::size_t i = 0; i + spec_.files < names.size(); ++i)
    ::unlink((spec_.folder + "/" + names[i]).c_str());
}

}  // namespace fieldcast
