#include "bridge/capture/capture_folder.hpp"

#include <fcntl.h>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <ctime>
#include <filesystem>
#include <map>
#include <optional>

#include "bridge/base/file_descriptor.hpp"
#include "bridge/capture/capture_ring.hpp"

namespace fieldcast {

namespace {

constexpr std::string_view kEnding = ".pcapng";
constexpr std::string_view kTimeForm = "20261122T142421Z";

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

// The part after the name of the bus: "20261122T142421Z" or "20261122T142421Z-0002".
bool is_ring_name(std::string_view rest) {
  if (!has_time_form(rest.substr(0, kTimeForm.size()))) return false;
  rest.remove_prefix(kTimeForm.size());
  return rest.empty() || (rest.size() == 5 && rest[0] == '-' &&
                          rest.find_first_not_of("0123456789", 1) == rest.npos);
}

}  // namespace

std::string ring_file_name(const std::string& bus, UtcTime begun, int number) {
  const std::string name = fmt::format("{}-{}", bus, time_name(begun));
  return number < 2 ? name + std::string(kEnding)
                    : fmt::format("{}-{:04}{}", name, number, kEnding);
}

std::vector<std::string> ring_files(const std::string& bus, std::vector<std::string> names) {
  std::erase_if(names, [&](const std::string& name) {
    std::string_view rest = name;
    if (!rest.starts_with(bus + "-") || !rest.ends_with(kEnding)) return true;
    rest.remove_prefix(bus.size() + 1);
    rest.remove_suffix(kEnding.size());
    return !is_ring_name(rest);
  });
  // Sorts without the ending, so that a name is before the same name with a number.
  std::ranges::sort(names, {}, [](const std::string& name) {
    return name.substr(0, name.size() - kEnding.size());
  });
  return names;
}

std::vector<std::string> ring_files_in(const std::string& folder, const std::string& bus) {
  std::vector<std::string> names;
  std::error_code error;
  for (std::filesystem::directory_iterator each(folder, error), end; !error && each != end;
       each.increment(error))
    names.push_back(each->path().filename().string());
  return ring_files(bus, std::move(names));
}

tl::expected<std::uint64_t, std::string> free_bytes_at(const std::string& folder) {
  struct statvfs disk {};
  if (::statvfs(folder.c_str(), &disk) != 0)
    return tl::unexpected(folder + ": " + errno_text(errno));
  return static_cast<std::uint64_t>(disk.f_bavail) * disk.f_frsize;
}

namespace {

constexpr std::uint64_t kMegabyte = 1'000'000;

std::uint64_t megabytes(std::uint64_t bytes) { return (bytes + kMegabyte - 1) / kMegabyte; }

// Size of the bus's existing ring files; their removal frees space for new files.
std::uint64_t bytes_of_ring(const std::string& bus, const std::string& folder) {
  std::uint64_t bytes = 0;
  for (const std::string& name : ring_files_in(folder, bus)) {
    std::error_code gone;
    const std::uint64_t size = std::filesystem::file_size(folder + "/" + name, gone);
    if (!gone) bytes += size;
  }
  return bytes;
}

// Free bytes that the captures checked so far leave, by disk.
using Room = std::map<dev_t, std::uint64_t>;

std::optional<CaptureRemark> room_remark(const BusSpec& bus, dev_t disk, Room& room) {
  const CaptureSpec& capture = *bus.capture;
  const auto free = free_bytes_at(capture.folder);
  if (!free) return std::nullopt;
  const auto [left, first] = room.try_emplace(disk, *free);
  const std::uint64_t most = capture.file_bytes * capture.files;
  const std::uint64_t there = bytes_of_ring(bus.name, capture.folder);
  const std::uint64_t wanted = most > there ? most - there : 0;
  const bool fits = left->second >= wanted + CaptureRing::kLeastFree;
  const std::uint64_t had = left->second;
  left->second -= std::min(left->second, wanted);
  if (fits) return std::nullopt;
  return CaptureRemark{
      0, bus.name, capture.folder,
      fmt::format("its files may take {} MB more, and {} MB are free: the capture stops when {} MB "
                  "are left",
                  megabytes(wanted), had / kMegabyte, CaptureRing::kLeastFree / kMegabyte),
      "make file-size or files smaller, or name a folder on another disk"};
}

std::optional<CaptureRemark> remark_of(const BusSpec& bus, Room& room) {
  const std::string& folder = bus.capture->folder;
  struct stat about {};
  if (::stat(folder.c_str(), &about) != 0) {
    const int error = errno;
    return CaptureRemark{0, bus.name, folder,
                         errno_text(error) + ": the bus runs, and nothing is captured",
                         error == ENOENT ? fmt::format("mkdir {}, with the user that runs the "
                                                       "bridge as its owner",
                                                       folder)
                                         : "name another folder"};
  }
  if (!S_ISDIR(about.st_mode))
    return CaptureRemark{0, bus.name, folder,
                         "this is no folder: the bus runs, nothing is captured", "name a folder"};
  if (::faccessat(AT_FDCWD, folder.c_str(), W_OK | X_OK, AT_EACCESS) != 0) {
    const int error = errno;
    return CaptureRemark{
        0, bus.name, folder,
        errno_text(error) + ": a bridge of the user that asks here captures nothing",
        fmt::format("{}; the service may write below /var/lib/fieldcast only",
                    error == EROFS ? "name a folder that can be written"
                                   : "make the user that runs the bridge its owner")};
  }
  return room_remark(bus, about.st_dev, room);
}

}  // namespace

std::vector<CaptureRemark> capture_remarks(const BridgeSpec& spec) {
  std::vector<CaptureRemark> remarks;
  Room room;
  for (std::size_t i = 0; i < spec.buses.size(); ++i) {
    if (!spec.buses[i].capture) continue;
    auto remark = remark_of(spec.buses[i], room);
    if (!remark) continue;
    remark->index = i;
    remarks.push_back(*std::move(remark));
  }
  return remarks;
}

}  // namespace fieldcast
