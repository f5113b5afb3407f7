#include "tools/sim/families/df1_device.hpp"

#include <algorithm>

#include "core/codec/checksum.hpp"

namespace fieldcast::sim {
namespace {

using namespace std::chrono_literals;

constexpr std::uint8_t kSoh = 0x01, kStx = 0x02, kEtx = 0x03, kEot = 0x04, kEnq = 0x05, kAck = 0x06,
                       kDle = 0x10, kNak = 0x15;
constexpr std::size_t kMostData = 260, kMostQueued = 4;
constexpr Duration kAcknowledgeTimeout = 1s;
constexpr unsigned kMostEnquiries = 3;

// Types of files; their elements have 1 or 3 words, or 2 words that are one item.
constexpr std::uint8_t kTypes[] = {0x89, 0x85, 0x8A, 0x91, 0x86, 0x87, 0x88, 0x84, 0x8B, 0x8C};
enum Area : std::size_t { kN, kB, kF, kL, kT, kC, kR, kS, kO, kI, kAreas };
constexpr std::uint32_t kElements = 1000, kSlots = 31, kSlotWords = 32, kStatus = 256;

bool is_long(std::size_t area) { return area == kF || area == kL; }
bool has_parts(std::size_t area) { return area == kT || area == kC || area == kR; }
bool by_slot(std::size_t area) { return area == kO || area == kI; }
std::uint32_t file_items(std::size_t area) {
  return area == kS        ? kStatus
         : by_slot(area)   ? kSlots * kSlotWords
         : has_parts(area) ? 3 * kElements
                           : kElements;
}
std::optional<std::uint32_t> only_file(std::size_t area) {
  if (area == kS) return 2;
  if (by_slot(area)) return area == kO ? 0 : 1;
  return std::nullopt;
}

std::vector<ItemArea> df1_areas() {
  std::vector<ItemArea> areas;
  for (std::size_t area = 0; area < kAreas; ++area)
    areas.push_back({kDf1AreaNames[area], is_long(area) ? 32u : 16u,
                     file_items(area) * (only_file(area) ? 1 : 256)});
  return areas;
}

Bytes check_of(ByteView counted, bool crc) {
  if (!crc) return {static_cast<std::uint8_t>(0 - sum8(counted))};
  const std::uint16_t sum = crc16_arc(counted);
  return {static_cast<std::uint8_t>(sum & 0xFF), static_cast<std::uint8_t>(sum >> 8)};
}

Bytes frame_of(const Bytes& packet, bool crc) {
  Bytes frame{kDle, kStx};
  Bytes counted;
  for (const std::uint8_t byte : packet) {
    counted.push_back(byte);
    frame.push_back(byte);
    if (byte == kDle) frame.push_back(kDle);
  }
  if (crc) counted.push_back(kEtx);
  append(frame, Bytes{kDle, kEtx});
  append(frame, check_of(counted, crc));
  return frame;
}

class Df1Receiver : public Receiver {
 public:
  Df1Receiver(Df1Device& device, std::uint8_t node, bool crc, bool half_duplex)
      : device_(device), node_(node), crc_(crc), half_(half_duplex) {}

  void on_character(std::uint8_t c, Instant end, Reaction& reaction) override {
    switch (state_) {
      case State::kIdle:
        if (c == kDle) state_ = State::kControl;
        break;
      case State::kControl: control(c, end, reaction); break;
      case State::kStation: station(c); break;
      case State::kData:
        if (c == kDle)
          state_ = State::kDataControl;
        else
          data_.push_back(c);
        break;
      case State::kDataControl: data_control(c); break;
      case State::kCheck:
        check_.push_back(c);
        if (check_.size() == (crc_ ? 2 : 1)) packet(end, reaction);
        break;
      case State::kPoll:
        if (c == kDle && !std::exchange(doubled_, true)) break;
        polled_ = c;
        state_ = State::kPollCheck;
        break;
      case State::kPollCheck:
        state_ = State::kIdle;
        if (polled_ == node_ && static_cast<std::uint8_t>(polled_ + c) == 0) poll(reaction);
        break;
    }
    if (data_.size() > kMostData) state_ = State::kIdle, data_.clear();
  }

  Instant sends_at() const override { return enquire_at_; }
  void send(Instant now, Reaction& reaction) override {
    if (enquiries_ == kMostEnquiries) {
      queued_.pop_front();
      return send_next(now, reaction);
    }
    ++enquiries_;
    enquire_at_ = now + kAcknowledgeTimeout;
    reaction.response = {kDle, kEnq};
  }

 private:
  enum class State { kIdle, kControl, kStation, kData, kDataControl, kCheck, kPoll, kPollCheck };

  void control(std::uint8_t c, Instant end, Reaction& reaction) {
    state_ = c == kDle ? State::kControl : State::kIdle;
    const bool addressed = std::exchange(addressed_, false);
    const bool sent = std::exchange(sent_, !half_ && sent_);
    if (c == kStx && (addressed || !half_)) {
      state_ = State::kData;
      data_.clear();
    } else if (c == kSoh && half_) {
      state_ = State::kStation;
      doubled_ = false;
    } else if (c == kEnq) {
      doubled_ = false;
      if (half_)
        state_ = State::kPoll;
      else
        append(reaction.response, Bytes{kDle, last_});
    } else if (c == kAck && sent && !queued_.empty()) {
      queued_.pop_front();
      sent_ = false;
      enquire_at_ = kNever;
      if (!half_) send_next(end, reaction);
    } else if (c == kNak && sent && !half_) {
      send_next(end, reaction);
    }
  }

  void station(std::uint8_t c) {
    if (c == kDle && !std::exchange(doubled_, true)) return;
    addressed_ = c == node_;
    state_ = State::kIdle;
  }

  void data_control(std::uint8_t c) {
    state_ = State::kData;
    if (c == kDle) return data_.push_back(c);
    if (c == kAck || c == kNak) return;
    if (c == kStx) return data_.clear();
    check_.clear();
    state_ = c == kEtx ? State::kCheck : State::kIdle;
  }

  void packet(Instant end, Reaction& reaction) {
    state_ = State::kIdle;
    Bytes counted;
    if (half_) counted.push_back(node_);
    if (half_ && crc_) counted.push_back(kStx);
    append(counted, data_);
    if (crc_) counted.push_back(kEtx);
    const bool right = check_ == check_of(counted, crc_) && data_.size() >= 6;
    last_ = right ? kAck : kNak;
    if (!right) {
      device_.bad_frame();
      if (!half_) append(reaction.response, Bytes{kDle, kNak});
      return;
    }
    if (data_[0] != node_) return;
    append(reaction.response, Bytes{kDle, kAck});
    const Bytes header{data_[1], data_[2], data_[4], data_[5]};
    if (std::exchange(header_, header) == header) return;
    Bytes response = device_.execute(data_, end);
    if (response.empty() || queued_.size() == kMostQueued) return;
    queued_.push_back(frame_of(response, crc_));
    late_ = data_[4] % 3 == 0;
    if (!half_ && queued_.size() == 1) send_next(end, reaction);
  }

  void poll(Reaction& reaction) {
    if (queued_.empty() || std::exchange(late_, false)) {
      append(reaction.response, Bytes{kDle, kEot});
      return;
    }
    sent_ = true;
    append(reaction.response, queued_.front());
  }

  void send_next(Instant now, Reaction& reaction) {
    enquire_at_ = kNever;
    enquiries_ = 0;
    sent_ = !queued_.empty();
    if (!sent_) return;
    enquire_at_ = now + kAcknowledgeTimeout;
    append(reaction.response, queued_.front());
  }

  Df1Device& device_;
  const std::uint8_t node_;
  const bool crc_, half_;
  State state_ = State::kIdle;
  bool doubled_ = false, addressed_ = false;
  std::uint8_t polled_ = 0;
  Bytes data_, check_;
  std::uint8_t last_ = kNak;
  Bytes header_;  // of the last command
  std::deque<Bytes> queued_;
  bool sent_ = false, late_ = false;  // the first one; half duplex: not ready at the first poll
  Instant enquire_at_ = kNever;
  unsigned enquiries_ = 0;
};

std::optional<ItemAddress> parse_df1_address(std::string_view at) {
  const std::size_t digits = std::min(at.find_first_of("0123456789:/"), at.size());
  const auto found = std::ranges::find(kDf1AreaNames, at.substr(0, digits));
  if (found == kDf1AreaNames.end()) return std::nullopt;
  ItemAddress address{.area = static_cast<std::size_t>(found - kDf1AreaNames.begin())};
  const std::size_t area = address.area;
  const std::size_t colon = at.find(':'), slash = at.find('/'), dot = at.find('.');
  const auto file_text = at.substr(digits, std::min({colon, slash, at.size()}) - digits);
  auto file = address_number(file_text);
  if (file_text.empty() && only_file(area)) file = *only_file(area);
  if (!file || *file > 255) return std::nullopt;
  const auto file_first =
      only_file(area) ? 0 : static_cast<std::uint32_t>(*file) * file_items(area);
  const auto bits = slash == std::string_view::npos ? "" : at.substr(slash + 1);
  if (colon == std::string_view::npos) {
    const auto bit = address_number(bits);
    if (area != kB || !bit) return std::nullopt;
    address.first = file_first + static_cast<std::uint32_t>(*bit / 16);
    address.bit = static_cast<std::uint8_t>(*bit % 16);
    return address;
  }
  const auto element =
      address_number(at.substr(colon + 1, std::min({slash, dot, at.size()}) - colon - 1));
  if (!element) return std::nullopt;
  const auto n = static_cast<std::uint32_t>(*element);
  const auto part =
      dot == std::string_view::npos ? std::string_view{} : at.substr(dot + 1, slash - dot - 1);
  auto bit = address_number(bits);
  address.first = file_first + n * (by_slot(area) ? kSlotWords : has_parts(area) ? 3 : 1);
  if (by_slot(area)) {
    const auto word = part.empty() ? bit.value_or(0) / 16 : address_number(part).value_or(99);
    address.first += static_cast<std::uint32_t>(word);
    if (part.empty() && bit) bit = *bit % 16;
  } else if (has_parts(area)) {
    if (part == "PRE" || part == "LEN") address.first += 1;
    if (part == "ACC" || part == "POS") address.first += 2;
    const auto named = !bits.empty() && !bit ? bits : part;
    if (named == "EN" || named == "CU") bit = 15;
    if (named == "TT" || named == "CD" || named == "EU") bit = 14;
    if (named == "DN") bit = 13;
    if (named == "OV" || named == "EM") bit = 12;
    if (named == "UN" || named == "ER") bit = 11;
    if (named == "UA" || named == "UL") bit = 10;
    if (named == "IN") bit = 9;
    if (named == "FD") bit = 8;
  }
  if (bit) address.bit = static_cast<std::uint8_t>(*bit);
  return address;
}

}  // namespace

Df1Device::Df1Device(const DeviceSetup& setup)
    : MemoryDevice({df1_areas(), setup}),
      node_(static_cast<std::uint8_t>(setup.spec.link.address)),
      crc_(!setup.spec.link.options.contains("check") ||
           setup.spec.link.options.at("check") == "crc"),
      half_duplex_(setup.spec.link.options.contains("duplex") &&
                   setup.spec.link.options.at("duplex") == "half") {}

std::unique_ptr<Receiver> Df1Device::open_receiver() {
  return std::make_unique<Df1Receiver>(*this, node_, crc_, half_duplex_);
}

Bytes Df1Device::execute(ByteView packet, Instant now) {
  if ((packet[2] & 0x40u) != 0) return {};  // a response
  Bytes response{packet[1], packet[0], static_cast<std::uint8_t>(packet[2] | 0x40u),
                 0,         packet[4], packet[5]};
  const auto refuse = [&](std::uint8_t status, std::uint8_t extended = 0) {
    ++statistics_.exceptions[status == 0xF0 ? 0xF000u + extended : status];
    response.resize(6);
    response[3] = status;
    if (status == 0xF0) response.push_back(extended);
    return response;
  };
  ++statistics_.responses;
  if (packet[2] != 0x0F || packet.size() < 12) return refuse(0x10);
  const std::uint8_t function = packet[6];
  ++statistics_.requests[to_hex({&function, 1})];
  if (function != 0xA2 && function != 0xAA && function != 0xAB) return refuse(0x10);
  std::size_t at = 8;
  const auto target = target_of(packet, at);
  if (!target) return refuse(0x50);
  const ByteView data = packet.subspan(at);
  const std::size_t size = packet[7];
  const std::size_t limit = function == 0xA2 ? 236 : 234;
  const std::size_t given = function == 0xA2 ? 0 : function == 0xAA ? size : size + 2;
  if (size > limit || data.size() != given) return refuse(0x10);
  if (const auto code = refusal_of(*target))
    return code == 0x50 ? refuse(code) : refuse(0xF0, code);
  if (function == 0xA2) {
    append(response, read(*target, now));
    return response;
  }
  if (by_slot(target->area)) return refuse(0xF0, 0x10);
  if (function == 0xAB && (size != 2 || is_long(target->area))) return refuse(0x10);
  ++statistics_.write_requests;
  if (function == 0xAA)
    write(*target, data);
  else
    write_masked(*target, data.first(2), data.subspan(2), now);
  return response;
}

std::optional<Df1Device::Target> Df1Device::target_of(ByteView packet, std::size_t& at) const {
  bool missing = false;
  const auto number = [&]() -> std::uint32_t {
    if (at < packet.size() && packet[at] != 0xFF) return packet[at++];
    missing = missing || at + 3 > packet.size();
    if (missing) return 0;
    at += 3;
    return packet[at - 2] + 256u * packet[at - 1];
  };
  const std::uint32_t file = number();
  missing = missing || at >= packet.size();
  const std::uint8_t type = missing ? 0 : packet[at++];
  const std::uint32_t element = number(), sub = number();
  const auto found = std::ranges::find(kTypes, type);
  if (missing || found == std::end(kTypes) || file > 255) return std::nullopt;
  Target target{.area = static_cast<std::size_t>(found - std::begin(kTypes))};
  const std::size_t area = target.area;
  if (only_file(area) && file != *only_file(area)) return std::nullopt;
  const std::uint32_t subs = by_slot(area) ? kSlotWords : has_parts(area) ? 3 : 1;
  const std::uint32_t in_file = element * subs + sub, bytes = is_long(area) ? 4 : 2;
  target.count = packet[7] / bytes;
  if (sub >= subs || packet[7] % bytes != 0 || target.count == 0 ||
      in_file + target.count > file_items(area))
    return std::nullopt;
  target.first = (only_file(area) ? 0 : file * file_items(area)) + in_file;
  return target;
}

std::uint8_t Df1Device::refusal_of(const Target& target) const {
  return memory_.refusal(target.area, target.first, target.count, 0x50);
}

Bytes Df1Device::read(const Target& target, Instant now) const {
  Bytes data;
  for (std::uint32_t i = 0; i < target.count; ++i) {
    const std::uint64_t item = memory_.read(target.area, target.first + i, now);
    for (unsigned byte = 0; byte < (is_long(target.area) ? 4 : 2); ++byte)
      data.push_back(static_cast<std::uint8_t>(item >> 8 * byte));
  }
  return data;
}

void Df1Device::write(const Target& target, ByteView data) {
  const std::size_t each = is_long(target.area) ? 4 : 2;
  for (std::uint32_t i = 0; i < target.count; ++i) {
    std::uint64_t item = 0;
    for (std::size_t byte = each; byte-- > 0;) item = item << 8 | data[i * each + byte];
    memory_.write(target.area, target.first + i, item, statistics_);
  }
}

void Df1Device::write_masked(const Target& target, ByteView mask, ByteView data, Instant now) {
  const auto word = [](ByteView bytes) { return bytes[0] + 256u * bytes[1]; };
  const std::uint64_t before = memory_.read(target.area, target.first, now);
  memory_.write(target.area, target.first,
                (before & ~std::uint64_t{word(mask)}) | (word(data) & word(mask)), statistics_);
}

tl::expected<std::unique_ptr<SimDevice>, std::string> make_df1_device(const DeviceSetup& setup) {
  return make_memory_device<Df1Device>(setup, 254, parse_df1_address);
}

}  // namespace fieldcast::sim
