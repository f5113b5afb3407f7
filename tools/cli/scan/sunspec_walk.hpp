// State machine that finds the SunSpec models of a Modbus device: next() returns the next read,
// on_response() and failed() process its result. The marker "SunS" is at one of three holding
// registers. A chain of models follows, each with a header of two registers (number, length), until
// the number 0xFFFF (SunSpec Device Information Model Specification). Replies are untrusted: the
// chain is limited, and an early end has a reason. Pure.
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
  std::uint32_t first = 0;   // holding register of its header
  std::uint16_t length = 0;  // registers after the header
  friend bool operator==(const SunSpecModel&, const SunSpecModel&) = default;
};

struct SunSpecMap {
  std::uint32_t base = 0;  // holding register of the marker
  std::vector<SunSpecModel> models;
  // Untrusted texts of the first common model (1); empty: none.
  std::string manufacturer, model, version, serial_number;
  std::string incomplete;  // why the walk ended early; empty: the chain is complete
};

class SunSpecWalk {
 public:
  static constexpr std::array<std::uint32_t, 3> kBases{40000, 50000, 0};
  static constexpr std::size_t kMostModels = 64;
  static constexpr unsigned kMostTries = 3;  // for one read

  struct Read {
    std::uint32_t first = 0, count = 0;  // holding registers
  };
  [[nodiscard]] std::optional<Read> next() const;
  // The registers of next(), two bytes each. Another number of bytes is a malformed response.
  void on_response(ByteView registers);
  // After a refused read of the marker, the next base is read. After a silent one the walk ends, so
  // that the search takes at most one timeout.
  void failed(Cause cause);

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
  unsigned tries_ = 0;        // failed tries of the read of next()
  std::optional<SunSpecMap> map_;
};

}  // namespace fieldcast::cli
