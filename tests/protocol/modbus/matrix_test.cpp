#include "tests/support/matrix.hpp"

#include <gtest/gtest.h>

#include "core/protocol/modbus/areas.hpp"
#include "core/protocol/modbus/framing.hpp"

namespace fieldcast::modbus {
namespace {

Bytes hex(std::string_view text) { return *from_hex(text); }

struct Wire {
  std::string name;
  const Framing& (*framing)();
  bool checked;
};

struct Row {
  std::string name;
  Request request;
  std::string answer;  // PDU
  Options options = {};
};

Range range(Table table, std::uint32_t first, std::uint32_t count) {
  return {static_cast<AreaIndex>(table), first, count};
}

const Row kRows[]{
    {"coils", ReadRequest{{range(Table::kCoil, 19, 19)}}, "01 03 CD6B05"},
    {"inputs", ReadRequest{{range(Table::kInput, 196, 22)}}, "02 03 ACDB35"},
    {"holding", ReadRequest{{range(Table::kHolding, 107, 3)}}, "03 06 AE41 5652 4340"},
    {"input_register", ReadRequest{{range(Table::kInputRegister, 8, 1)}}, "04 02 000A"},
    {"write_coil", WriteRequest{.range = range(Table::kCoil, 172, 1), .items = {1}},
     "05 00AC FF00"},
    {"write_register", WriteRequest{.range = range(Table::kHolding, 1, 1), .items = {0, 3}},
     "06 0001 0003"},
    {"write_coils", WriteRequest{.range = range(Table::kCoil, 19, 3), .items = {1, 0, 1}},
     "0F 0013 0003"},
    {"write_registers", WriteRequest{.range = range(Table::kHolding, 1, 2), .items = {0, 10, 1, 2}},
     "10 0001 0002"},
    {"mask_write",
     WriteRequest{.range = range(Table::kHolding, 4, 1), .items = {0, 4}, .bit = 2},
     "16 0004 FFFB 0004",
     {.mask_write = true}},
    {"read_write",
     WriteReadRequest{{.range = range(Table::kHolding, 14, 1), .items = {0, 255}},
                      range(Table::kHolding, 3, 2)},
     "17 04 00FE 0ACD"},
    {"records", ReadRequest{{range(Table::kFile, 40001, 2), range(Table::kFile, 30009, 1)}},
     "14 0A 05 06 0DFE 0020 03 06 33CD"},
    {"write_records",
     WriteRequest{.range = range(Table::kFile, 40007, 2), .items = {6, 0xAF, 4, 0xBE}},
     "15 0B 06 0004 0007 0002 06AF 04BE"},
    {"object", ReadRequest{{range(Table::kIdentity, 244, 9)}},
     "2B 0E 04 81 00 00 01 01 09 49 4E 56 2D 43 61 70 70 6F"},
    {"queue", ReadRequest{{range(Table::kFifo, 1246 * 32, 4)}}, "18 0006 0002 01B8 1284"},
    {"exception", ReadRequest{{range(Table::kHolding, 107, 3)}}, "83 02"},
    {"busy", ReadRequest{{range(Table::kCoil, 107, 3)}}, "81 06"},
};

class ModbusMatrix : public testing::TestWithParam<std::tuple<Wire, Row>> {
 protected:
  test::MatrixCase matrix() const {
    const auto& [wire, row] = GetParam();
    const Header header{17, 0x1501};
    Bytes answer;
    wire.framing().wrap(header, hex(row.answer), answer);
    return {.begin =
                [&framing = wire.framing(), header, &tried = row] {
                  return std::make_unique<ModbusExchange>(framing, header, tried.request,
                                                          tried.options);
                },
            .answers = {answer},
            .checked = wire.checked,
            .noise_recovers = wire.checked};
  }
};

TEST_P(ModbusMatrix, EveryCellIsTheSameValueOrNone) { test::expect_matrix(matrix()); }
TEST_P(ModbusMatrix, RandomBytesAreRefused) {
  test::expect_random_bytes_are_refused(matrix(), 4711, 3000);
}

TEST_P(ModbusMatrix, AnnouncedSizesAreExact) {
  const auto& [wire, row] = GetParam();
  ModbusExchange exchange(wire.framing(), Header{17, 0x1501}, row.request, row.options);
  const auto sizes = pdu_sizes(row.request, row.options);
  ASSERT_TRUE(sizes.has_value());
  Bytes request;
  const Step step = exchange.start(request);
  EXPECT_EQ(step.kind, Step::Kind::kSend);
  EXPECT_EQ(request.size(), wire.framing().size(sizes->request));
  EXPECT_EQ(step.characters, wire.framing().size(sizes->response));
  if (RequestPdu(row.request, row.options).varies()) {
    EXPECT_GT(sizes->response, hex(row.answer).size());
  } else if (hex(row.answer)[0] < kExceptionFlag) {
    EXPECT_EQ(sizes->response, hex(row.answer).size());
  }
}

INSTANTIATE_TEST_SUITE_P(All, ModbusMatrix,
                         testing::Combine(testing::Values(Wire{"rtu", rtu_framing, true},
                                                          Wire{"ascii", ascii_framing, true},
                                                          Wire{"tcp", tcp_framing, false}),
                                          testing::ValuesIn(kRows)),
                         [](const auto& instance) {
                           return std::get<0>(instance.param).name + "_" +
                                  std::get<1>(instance.param).name;
                         });

}  // namespace
}  // namespace fieldcast::modbus
