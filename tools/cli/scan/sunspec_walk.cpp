#include "tools/cli/scan/sunspec_walk.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace fieldcast::cli {
namespace {

constexpr std::uint32_t kAllRegisters = 65536;
constexpr std::uint16_t kEnd = 0xFFFF, kCommonModel = 1;
constexpr std::array<std::uint8_t, 4> kMarkerBytes{'S', 'u', 'n', 'S'};

// A text of the common model: offset from the header and length, in registers.
struct CommonText {
  std::string SunSpecMap::*text;
  std::uint32_t offset, registers;
};
constexpr CommonText kCommonTexts[] = {{&SunSpecMap::manufacturer, 2, 16},
                                       {&SunSpecMap::model, 18, 16},
                                       {&SunSpecMap::version, 42, 8},
                                       {&SunSpecMap::serial_number, 50, 16}};
// from the header to the end of the last text, without the header
constexpr std::uint32_t kCommonRegisters = 64;

// Removes padding zeros and blanks.
std::string filled_text(ByteView bytes) {
  std::string text(bytes.begin(), std::find(bytes.begin(), bytes.end(), std::uint8_t{0}));
  text.erase(text.find_last_not_of(' ') + 1);
  return text;
}

}  // namespace

std::optional<SunSpecWalk::Read> SunSpecWalk::next() const {
  switch (phase_) {
    case Phase::kMarker: return Read{kBases[base_], kSunSpecHeader};
    case Phase::kHeader: return Read{header_, kSunSpecHeader};
    case Phase::kCommon: {
      const SunSpecModel& model = map_->models.back();
      return Read{model.first + kSunSpecHeader,
                  std::min<std::uint32_t>(model.length, kCommonRegisters)};
    }
    case Phase::kOver: break;
  }
  return std::nullopt;
}

void SunSpecWalk::on_response(ByteView registers) {
  const auto read = next();
  if (!read) return;
  if (registers.size() != 2 * std::size_t{read->count}) return failed(Cause::kMalformed);
  tries_ = 0;
  switch (phase_) {
    case Phase::kMarker: return marker(registers);
    case Phase::kHeader: return header(registers);
    case Phase::kCommon: return common(registers);
    case Phase::kOver: break;
  }
}

void SunSpecWalk::failed(Cause cause) {
  const bool refused = cause == Cause::kDeviceError || cause == Cause::kUnsupported;
  const bool silent_marker = phase_ == Phase::kMarker && cause == Cause::kNoResponse;
  if (!refused && !silent_marker && ++tries_ < kMostTries) return;
  tries_ = 0;
  if (phase_ == Phase::kMarker) {
    if (refused) return next_base();
    phase_ = Phase::kOver;
  } else if (phase_ == Phase::kHeader) {
    end(fmt::format("the header at holding:{} cannot be read: {}", header_, to_text(cause)));
  } else if (phase_ == Phase::kCommon) {
    next_header();  // continues without the texts
  }
}

void SunSpecWalk::marker(ByteView registers) {
  if (!std::equal(registers.begin(), registers.end(), kMarkerBytes.begin())) return next_base();
  map_.emplace();
  map_->base = kBases[base_];
  header_ = map_->base + kSunSpecHeader;
  phase_ = Phase::kHeader;
}

void SunSpecWalk::next_base() {
  if (++base_ == kBases.size()) phase_ = Phase::kOver;
}

void SunSpecWalk::header(ByteView registers) {
  const auto number = static_cast<std::uint16_t>(registers[0] << 8 | registers[1]);
  const auto length = static_cast<std::uint16_t>(registers[2] << 8 | registers[3]);
  if (number == kEnd) return end({});
  if (number == 0) return end(fmt::format("the model at holding:{} has the number 0", header_));
  const std::uint32_t behind = header_ + kSunSpecHeader + length;
  if (behind > kAllRegisters)
    return end(
        fmt::format("model {} at holding:{} has a length of {} registers, beyond register {}",
                    number, header_, length, kAllRegisters - 1));
  if (map_->models.size() == kMostModels)
    return end(fmt::format("there are more than {} models", kMostModels));
  const bool named =
      std::ranges::find(map_->models, kCommonModel, &SunSpecModel::number) != map_->models.end();
  map_->models.push_back({number, header_, length});
  header_ = behind;
  if (number == kCommonModel && !named && length != 0)
    phase_ = Phase::kCommon;
  else
    next_header();
}

void SunSpecWalk::next_header() {
  phase_ = Phase::kHeader;
  if (header_ + kSunSpecHeader > kAllRegisters) end("the last model has no end mark behind it");
}

void SunSpecWalk::common(ByteView registers) {
  for (const CommonText& each : kCommonTexts) {
    const std::size_t from = 2 * std::size_t{each.offset - kSunSpecHeader};
    if (from >= registers.size()) break;
    const std::size_t size = std::min(2 * std::size_t{each.registers}, registers.size() - from);
    (*map_).*each.text = filled_text(registers.subspan(from, size));
  }
  next_header();
}

void SunSpecWalk::end(std::string incomplete) {
  map_->incomplete = std::move(incomplete);
  phase_ = Phase::kOver;
}

}  // namespace fieldcast::cli
