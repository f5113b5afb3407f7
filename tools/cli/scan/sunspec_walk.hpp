// Finds the SunSpec models of a Modbus device: the marker "SunS" at one of three holding registers,
// behind it a chain of models, each with a header of two registers (number and length), up to the
// number 0xFFFF (SunSpec Device Information Model Specification). A state machine:
// next() returns what to read, answered() and failed() take the outcome. Replies are hostile: the
// chain has limits, and its end is reported with a reason. Pure; one owner.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/bytes.hpp"
#include "core/base/cause.hpp"

namespace fieldcast::cli {

inline constexpr std::uint32_t kSunSpecHeader = 2;  // registers: number and length

struct SunSpecModel {
  std::uint16_t number = 0;  // 103
  std::uint32_t first = 0;   // the holding register of its header
  std::uint16_t length = 0;  // registers behind the header
  friend bool operator==(const SunSpecModel&, const SunSpecModel&) = default;
};

struct SunSpecMap {
  std::uint32_t base = 0;  // the holding register of the marker
  std::vector<SunSpecModel> models;
  // Of the first common model (1), as the device sent them; empty: none.
  std::string manufacturer, model, version, serial_number;
  std::string incomplete;  // why the chain was left before its end; empty: it is whole
};

class SunSpecWalk {
 public:
  static constexpr std::array<std::uint32_t, 3> kBases{40000, 50000, 0};
  static constexpr std::size_t kMostModels = 64;
  static constexpr unsigned kMostTries = 3;  // of one read

  struct Read {
    std::uint32_t first = 0, count = 0;  // holding registers
  };
  // Empty: the walk is over.
  [[nodiscard]] std::optional<Read> next() const;
  // The registers of next(), two bytes each. Another number of bytes is a malformed response.
  void answered(ByteView registers);
  // A device that refuses the marker is read at the next base. One that is silent then is left, so
  // that the search costs one timeout at most.
  void failed(Cause cause);

  // Empty: the device has no SunSpec models.
  [[nodiscard]] const std::optional<SunSpecMap>& map() const { return map_; }

 private:
  enum class Phase : std::uint8_t { kMarker, kHeader, kCommon, kOver };
  void marker(ByteView registers);
  void next_base();
  void header(ByteView registers);
  void next_header();
  void common(ByteView registers);
  void end(std::string incomplete);

  Phase phase_ = Phase::kMarker;
  std::size_t base_ = 0;      // index in kBases
  std::uint32_t header_ = 0;  // register of the next header
  unsigned tries_ = 0;        // of the read of next() that failed
  std::optional<SunSpecMap> map_;
};

}  // namespace fieldcast::cli
