// Captures of simulated devices in virtual time, and what `inspect --learn` finds in them as lines
// that compare with those of a declaration.
#pragma once

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <random>

#include "config/loader/loader.hpp"
#include "core/codec/checksum.hpp"
#include "tools/cli/inspect/learn/proposal.hpp"
#include "tools/sim/check/requests.hpp"

namespace fieldcast::learn {

using declared::Declaration;
using declared::Field;
using declared::FieldKind;
using testing::HasSubstr;

inline std::shared_ptr<const Declaration> shipped(const std::string& name) {
  const auto loaded = config::load_declaration(name);
  if (!loaded) throw std::runtime_error(config::to_text(std::span(loaded.error())));
  return loaded->value;
}

struct Read {
  std::string area;
  std::uint32_t first = 0, count = 1;
};

// A line with devices of a declared protocol; random contents.
class Plant {
 public:
  explicit Plant(const std::string& protocol) : Plant(shipped(protocol)) {}
  explicit Plant(std::shared_ptr<const Declaration> declaration)
      : declaration_(std::move(declaration)) {}

  void use(const std::string& address) {
    auto subject = sim::subjects_of(declared::SharedDeclaration{declaration_}).front();
    subject.device.link.long_address = address;
    protocol_ = subject.protocol();
    device_ = std::make_unique<sim::LiveDevice>(subject);
  }

  void read(const Read& read) {
    const auto& areas = declaration_->areas;
    const auto area = std::ranges::find(areas, read.area, &declared::DeclaredArea::name);
    ASSERT_NE(area, areas.end()) << read.area;
    const auto index = static_cast<AreaIndex>(area - areas.begin());
    for (std::uint32_t i = 0; i < read.count && area->places.empty(); ++i)
      EXPECT_TRUE(device_->device().poke(read.area, read.first + i, contents(*area)));
    for (const declared::Place& place : area->places) set_place(read.area, place);
    const bool whole = !area->places.empty();
    const Range range{index, read.first, whole ? area->items : read.count};
    run(ReadRequest{{range}});
  }
  void write(const std::string& area, std::uint32_t first, Bytes items) {
    const auto& areas = declaration_->areas;
    const auto index = static_cast<AreaIndex>(
        std::ranges::find(areas, area, &declared::DeclaredArea::name) - areas.begin());
    run(WriteRequest{.range = {index, first, 1}, .items = std::move(items)});
  }

  void take(ByteView request, ByteView response) {
    pairing_.take(Direction::kSent, request);
    pairing_.take(Direction::kReceived, response);
  }
  // A text of a place.
  std::function<std::string(const declared::Place&)> text_of;

  Proposal learned() { return learn(exchanges = pairing_.finish()); }
  std::vector<Exchange> exchanges;
  const Declaration& declaration() const { return *declaration_; }
  std::mt19937 random{7};

 private:
  void run(const Request& request) {
    Bytes out;
    auto exchange = protocol_->begin(request, device_->context(0));
    const auto outcome = device_->run(std::move(exchange));
    ASSERT_TRUE(outcome.done) << outcome.text() << ' ' << sim::frames(outcome.sent);
    for (std::size_t i = 0; i < outcome.sent.size(); ++i)
      take(outcome.sent[i], outcome.responses[i]);
  }
  std::uint64_t contents(const declared::DeclaredArea& area) {
    if (declaration_->name == "dlt645-2007") return random() % 100000000;
    return random() & (UINT64_MAX >> (64 - area.item_bits));
  }
  void set_place(const std::string& area, const declared::Place& place) {
    std::string text = text_of ? text_of(place) : "";
    for (std::uint32_t i = 0; i < place.items; ++i) {
      std::uint64_t item = random() & 0xFFFF;
      if (place.characters != 0) {
        const auto at = [&](std::size_t n) {
          return static_cast<std::uint8_t>(n < text.size() ? text[n] : 0);
        };
        item = static_cast<std::uint64_t>(at(2 * i) << 8 | at(2 * i + 1));
      } else if (place.name == "state" && !text.empty()) {
        item = static_cast<std::uint8_t>(text.front());
      } else if (place.bits < 16) {
        item &= (1u << place.bits) - 1u;
      }
      (void)device_->device().poke(area, place.first + i, item);
    }
  }

  std::shared_ptr<const Declaration> declaration_;
  std::unique_ptr<Protocol> protocol_;
  std::unique_ptr<sim::LiveDevice> device_;
  ExchangePairing pairing_;
};

// A frame as one line for each field: position, kind and notation. Fixed characters are one line,
// as a capture shows no difference between a constant, a command and the code of no error.
class FrameLines {
 public:
  FrameLines(const declared::Frame& frame, const declared::Operation& operation)
      : frame_(frame), command_(operation.command) {}

  std::vector<std::string> run() {
    for (std::size_t i = 0; i < frame_.fields.size(); ++i) add(i);
    flush();
    return std::move(lines_);
  }

 private:
  static bool is_open(const Field& field) {
    return field.kind == FieldKind::kItems || field.variable || !field.key.empty();
  }
  static std::size_t size_of(const Field& field) {
    if (field.text_size != 0) return field.text_size;
    return field.text.empty() ? field.word.characters : field.text.size();
  }
  // From the start of the frame, or from its end behind a field of open length, or the field.
  std::string edge(std::size_t at) const {
    std::size_t size = 0;
    for (std::size_t i = 0; i < frame_.fields.size(); ++i) {
      if (i == at) return fmt::format("{}", size);
      if (is_open(frame_.fields[i])) break;
      size += size_of(frame_.fields[i]);
    }
    size = 0;
    for (std::size_t i = at; i < frame_.fields.size(); ++i) {
      if (is_open(frame_.fields[i])) return fmt::format("#{}", lines_.size());
      size += size_of(frame_.fields[i]);
    }
    return fmt::format("-{}", size);
  }
  std::string span(const Field& field) const {
    return fmt::format("{}..{}", edge(field.of.from), edge(field.of.to + 1u));
  }
  static std::string word(const Field& field) {
    // No capture shows the byte order of values, and of numbers of devices.
    const bool shown = field.kind != FieldKind::kItems && field.kind != FieldKind::kAddress;
    return fmt::format(
        "{}{}{}{}", field.word.characters,
        std::vector{"b", "h", "d", "c"}[static_cast<std::size_t>(field.word.notation)],
        shown && field.word.little_endian && field.word.characters > 1 ? "<" : "",
        field.transform.add != 0 ? fmt::format(" add {:02X}", field.transform.add) : "");
  }

  void add(std::size_t i) {
    const Field& field = frame_.fields[i];
    const bool command = field.kind == FieldKind::kCommand;
    if (field.kind == FieldKind::kConstant || command || field.kind == FieldKind::kError) {
      if (fixed_.empty()) fixed_at_ = edge(i);
      if (!field.text.empty())
        append(fixed_, ByteView(reinterpret_cast<const std::uint8_t*>(field.text.data()),
                                field.text.size()));
      else
        declared::append_word(
            fixed_, field.word,
            command ? command_ + static_cast<std::uint64_t>(field.plus) : field.number);
      return;
    }
    flush();
    std::string text;
    switch (field.kind) {
      case FieldKind::kAddress: text = "address " + word(field); break;
      case FieldKind::kFirst: text = "first " + word(field); break;
      case FieldKind::kCount: text = "count " + word(field); break;
      case FieldKind::kLast: text = "last " + word(field); break;
      case FieldKind::kLength:
        text = fmt::format("length {} of {} plus {} counts {}", word(field), span(field),
                           field.plus, static_cast<int>(field.counts));
        break;
      case FieldKind::kItems: text = field.packed ? "items of bits" : "items " + word(field); break;
      case FieldKind::kValue:
        text = field.text_size == 0
                   ? "value " + word(field)
                   : fmt::format("value text {} number {}", field.variable ? 0 : field.text_size,
                                 static_cast<int>(field.text_number.kind));
        break;
      case FieldKind::kChecksum:
        text = fmt::format("checksum {} of {} kind {} complement {} crc {}/{:X}/{:X}/{:X}/{}{}{}",
                           word(field), span(field), static_cast<int>(field.check.kind),
                           static_cast<int>(field.check.complement), field.check.crc.width,
                           field.check.crc.polynomial, field.check.crc.start,
                           field.check.crc.final_xor, field.check.crc.reflect_in,
                           field.check.crc.reflect_out, field.check.over_bytes ? " bytes" : "");
        break;
      case FieldKind::kSequence: text = "sequence " + word(field); break;
      default: text = "unused " + word(field); break;
    }
    lines_.push_back(edge(i) + ' ' + text);
  }

  void flush() {
    if (!fixed_.empty()) lines_.push_back(fixed_at_ + " fixed " + to_hex(fixed_));
    fixed_.clear();
  }

  const declared::Frame& frame_;
  const std::uint64_t command_;
  std::vector<std::string> lines_;
  Bytes fixed_;
  std::string fixed_at_;
};

using Lines = std::vector<std::string>;
inline Lines lines_of(const declared::Operation& operation, bool response) {
  return FrameLines(response ? operation.response : operation.request, operation).run();
}

// The declaration as the loader reads it; it must accept every proposal.
inline std::shared_ptr<const Declaration> declared_by(const Proposal& proposal) {
  const std::string text = declaration_text(proposal);
  const auto loaded = config::load_declaration_text(text, "learned.yaml");
  if (!loaded) {
    ADD_FAILURE() << config::to_text(std::span(loaded.error())) << text;
    return std::make_shared<Declaration>();
  }
  if (std::getenv("FIELDCAST_SHOW") != nullptr) std::puts(text.c_str());
  return loaded->value;
}

// The declaration finds no fault in any frame of the capture.
inline std::shared_ptr<const Declaration> declared_by(Plant& plant) {
  const auto learned = declared_by(plant.learned());
  const Evidence explained = explained_by(*learned, plant.exchanges);
  EXPECT_EQ(explained.holds, explained.of);
  EXPECT_EQ(explained.of, 2 * plant.exchanges.size());
  return learned;
}

inline const declared::Operation& operation(const Declaration& declaration, std::string_view name) {
  const auto found = std::ranges::find(declaration.operations, name, &declared::Operation::name);
  if (found == declaration.operations.end()) throw std::runtime_error(std::string(name));
  return *found;
}

// The learned operations, in their order, are these of the shipped declaration.
inline void expect_same(const Declaration& learned, const Declaration& shipped,
                        const std::vector<std::string>& names) {
  ASSERT_EQ(learned.operations.size(), names.size());
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto& expected = operation(shipped, names[i]);
    EXPECT_EQ(lines_of(learned.operations[i], false), lines_of(expected, false)) << names[i];
    EXPECT_EQ(lines_of(learned.operations[i], true), lines_of(expected, true)) << names[i];
  }
}

// Reads of different items and lengths, from each device.
inline void read_all(Plant& plant, std::initializer_list<const char*> addresses,
                     const std::vector<std::string>& areas,
                     std::initializer_list<std::uint32_t> firsts,
                     std::initializer_list<std::uint32_t> counts) {
  for (const char* address : addresses) {
    plant.use(address);
    for (const std::uint32_t first : firsts) {
      for (const std::uint32_t count : counts) {
        for (const std::string& area : areas) plant.read({area, first, count});
      }
    }
  }
}

}  // namespace fieldcast::learn
