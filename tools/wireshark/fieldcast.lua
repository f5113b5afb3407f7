-- Dissectors for Wireshark 4.0 and later: what `fieldcast capture` writes of protocols that Wireshark does not know, and
-- `fieldcast/Sample` inside RTPS. docs/wireshark.md says how to install it.
--
-- A capture names the dissector of each frame (LINKTYPE_WIRESHARK_UPPER_PDU): "fieldcast-" and the name of the protocol. Modbus RTU
-- and TCP are dissected by Wireshark itself.

local PREFIX = "fieldcast-"

-- A protocol with its fields and one expert info for what is wrong with a frame.
local function new_protocol(name, description, fields)
  local proto = Proto(PREFIX .. name, description)
  local filter = "fieldcast_" .. name:gsub("-", "_") .. "."
  local made = {}
  for key, row in pairs(fields) do
    made[key] = row[1](filter .. key, row[2], row[3], row[4])
  end
  local list = {}
  for _, field in pairs(made) do list[#list + 1] = field end
  proto.fields = list
  local fault = ProtoExpert.new(filter .. "fault", "Fault of the frame", expert.group.MALFORMED, expert.severity.WARN)
  proto.experts = { fault }
  return proto, made, fault
end

local function begin(proto, buffer, pinfo, tree, column)
  pinfo.cols.protocol = column
  pinfo.cols.info = ""
  return tree:add(proto, buffer())
end

local function info(pinfo, text) pinfo.cols.info = text end

local function xor_of(buffer, first, last)
  local sum = 0
  for i = first, last do sum = bit.bxor(sum, buffer(i, 1):uint()) end
  return sum
end

local function sum_of(buffer, first, last)
  local sum = 0
  for i = first, last do sum = (sum + buffer(i, 1):uint()) % 256 end
  return sum
end

local function crc16(buffer, first, last)
  local crc = 0xFFFF
  for i = first, last do
    crc = bit.bxor(crc, buffer(i, 1):uint())
    for _ = 1, 8 do
      local carry = crc % 2
      crc = math.floor(crc / 2)
      if carry == 1 then crc = bit.bxor(crc, 0xA001) end
    end
  end
  return crc
end

local function check(tree, fault, field, range, found, right)
  local item = tree:add(field, range)
  if found ~= right then item:add_proto_expert_info(fault, "wrong check: should be " .. right) end
end

local function hex2(number) return string.format("%02X", number) end

-- ---- Modbus ASCII: as RTU in hexadecimal; what is in it goes to Wireshark's own dissector.

do
  local proto, f, fault = new_protocol("modbus-ascii", "Modbus ASCII", {
    unit = { ProtoField.uint8, "Unit" },
    lrc = { ProtoField.string, "LRC" },
    text = { ProtoField.string, "Frame" },
  })
  local rtu = Dissector.get("mbrtu")

  function proto.dissector(buffer, pinfo, tree)
    local sub = begin(proto, buffer, pinfo, tree, "Modbus ASCII")
    local text = buffer():string()
    local digits = text:match("^:(%x+)\r\n")
    if not digits or #digits < 6 or #digits % 2 == 1 then
      sub:add(f.text, buffer()):add_proto_expert_info(fault, "no whole frame: ':', pairs of digits, CR LF")
      info(pinfo, "No whole frame")
      return buffer:len()
    end
    local sum, bytes = 0, {}
    for pair in digits:gmatch("%x%x") do bytes[#bytes + 1] = tonumber(pair, 16) end
    for i = 1, #bytes - 1 do sum = (sum + bytes[i]) % 256 end
    sub:add(f.unit, buffer(1, 2), bytes[1])
    check(sub, fault, f.lrc, buffer(#digits - 1, 2), digits:sub(-2):upper(), hex2((256 - sum) % 256))
    -- The RTU frame of the same content, with its CRC.
    local content = ByteArray.new(digits:sub(1, -3))
    local plain = content:tvb("Modbus RTU")
    local crc = crc16(plain, 0, plain:len() - 1)
    content:append(ByteArray.new(hex2(crc % 256) .. hex2(math.floor(crc / 256))))
    rtu:call(content:tvb("The same as Modbus RTU"), pinfo, tree)
    pinfo.cols.protocol = "Modbus ASCII"
    return buffer:len()
  end
end

-- ---- Omron Host Link: C-mode and FINS

do
  local proto, f, fault = new_protocol("omron-hostlink", "Omron Host Link", {
    unit = { ProtoField.string, "Unit" },
    header = { ProtoField.string, "Header" },
    end_code = { ProtoField.string, "End code" },
    first = { ProtoField.string, "First word" },
    count = { ProtoField.string, "Count" },
    data = { ProtoField.string, "Data" },
    sid = { ProtoField.string, "FINS service id" },
    command = { ProtoField.string, "FINS command" },
    area = { ProtoField.string, "FINS area" },
    address = { ProtoField.string, "FINS address" },
    fcs = { ProtoField.string, "FCS" },
    text = { ProtoField.string, "Frame" },
  })
  local AREAS = { D = "DM", R = "CIO", L = "LR", H = "HR", J = "AR", C = "T/C", G = "TF/CF", E = "EM", S = "status" }
  local FINS = { ["0101"] = "read", ["0102"] = "write", ["0104"] = "read scattered" }

  local function fins(buffer, sub, text, sent, last)
    -- A request has the wait character, an answer the end code of two.
    local at = sent and 6 or 7
    local icf = tonumber(text:sub(at + 1, at + 2), 16)
    if not icf then return "FINS" end
    local relayed = icf >= 0x80 and icf ~= 0xFF
    local sid = at + (relayed and 18 or 6)
    local command = sid + 2
    if command + 4 > last then return "FINS" end
    sub:add(f.sid, buffer(sid, 2))
    sub:add(f.command, buffer(command, 4))
    local name = FINS[text:sub(command + 1, command + 4)] or text:sub(command + 1, command + 4)
    local rest = command + 4
    if not sent then
      if rest + 4 <= last then
        sub:add(f.end_code, buffer(rest, 4))
        if rest + 4 < last then sub:add(f.data, buffer(rest + 4, last - rest - 4)) end
      end
      return "FINS " .. name .. ", end code " .. text:sub(rest + 1, rest + 4)
    end
    if rest + 12 <= last and name ~= "read scattered" then
      sub:add(f.area, buffer(rest, 2))
      sub:add(f.address, buffer(rest + 2, 6))
      sub:add(f.count, buffer(rest + 8, 4))
      if rest + 12 < last then sub:add(f.data, buffer(rest + 12, last - rest - 12)) end
    elseif rest < last then
      sub:add(f.data, buffer(rest, last - rest))
    end
    return "FINS " .. name
  end

  local function c_mode(buffer, sub, text, sent, last)
    local header = text:sub(4, 5)
    local area = AREAS[header:sub(2, 2)] or header
    local verb = header:sub(1, 1) == "R" and "read " or header:sub(1, 1) == "W" and "write " or ""
    if not sent then
      if last >= 7 then sub:add(f.end_code, buffer(5, 2)) end
      if last > 7 then sub:add(f.data, buffer(7, last - 7)) end
      return verb .. area .. ", end code " .. text:sub(6, 7)
    end
    if last >= 9 then sub:add(f.first, buffer(5, 4)) end
    if verb == "read " and last >= 13 then sub:add(f.count, buffer(9, 4)) end
    if verb == "write " and last > 9 then sub:add(f.data, buffer(9, last - 9)) end
    return verb .. area .. " " .. text:sub(6, 9)
  end

  function proto.dissector(buffer, pinfo, tree)
    local sub = begin(proto, buffer, pinfo, tree, "Host Link")
    local text, length = buffer():string(), buffer:len()
    local sent = pinfo.dst_port == 502
    if text == "\r" then
      info(pinfo, "Delimiter: the next part, please")
      return length
    end
    local star = text:find("*", 1, true)
    local last = (star and star - 1 or length - 1) - 2  -- where the FCS begins
    if last < 1 then
      sub:add(f.text, buffer()):add_proto_expert_info(fault, "no whole frame")
      info(pinfo, "No whole frame")
      return length
    end
    local says
    if text:sub(1, 1) ~= "@" then
      sub:add(f.data, buffer(0, last))
      says = "more data"
    elseif last < 5 then
      sub:add(f.text, buffer()):add_proto_expert_info(fault, "too short")
      info(pinfo, "Too short")
      return length
    else
      sub:add(f.unit, buffer(1, 2))
      sub:add(f.header, buffer(3, 2))
      local fields = text:sub(4, 5) == "FA" and fins or c_mode
      says = "unit " .. text:sub(2, 3) .. ": " .. fields(buffer, sub, text, sent, last)
    end
    check(sub, fault, f.fcs, buffer(last, 2), text:sub(last + 1, last + 2), hex2(xor_of(buffer, 0, last - 1)))
    info(pinfo, (sent and "Request " or "Answer ") .. says)
    return length
  end
end

-- ---- Siemens S7-200 PPI

do
  local proto, f, fault = new_protocol("s7-ppi", "S7-200 PPI", {
    start = { ProtoField.uint8, "Start", base.HEX },
    length = { ProtoField.uint8, "Length" },
    to = { ProtoField.uint8, "To" },
    from = { ProtoField.uint8, "From" },
    control = { ProtoField.uint8, "Control", base.HEX },
    kind = { ProtoField.uint8, "Kind of unit", base.DEC, { [1] = "request", [2] = "answer", [3] = "answer with data", [7] = "user data" } },
    reference = { ProtoField.uint16, "Reference", base.HEX },
    error_code = { ProtoField.uint16, "Error", base.HEX },
    func = { ProtoField.uint8, "Function", base.DEC, { [4] = "read", [5] = "write" } },
    items = { ProtoField.uint8, "Items" },
    item = { ProtoField.string, "Item" },
    result = { ProtoField.uint8, "Result", base.HEX },
    data = { ProtoField.bytes, "Data" },
    fcs = { ProtoField.uint8, "FCS", base.HEX },
    rest = { ProtoField.bytes, "Bytes" },
  })
  local AREAS = { [0x03] = "S", [0x04] = "SM", [0x05] = "S", [0x06] = "AI", [0x07] = "AQ", [0x1E] = "C", [0x1F] = "T",
    [0x81] = "I", [0x82] = "Q", [0x83] = "M", [0x84] = "V" }
  local COUNTED = { [0x1E] = true, [0x1F] = true }

  local function item_text(range)
    local area, address = range(8, 1):uint(), range(9, 3):uint()
    local name = AREAS[area] or ("area " .. hex2(area) .. " ")
    local number = COUNTED[area] and tostring(address) or tostring(math.floor(address / 8))
    if range(3, 1):uint() == 1 then number = number .. "." .. (address % 8) end
    return string.format("%s%s, type %02X, count %d", name, number, range(3, 1):uint(), range(4, 2):uint())
  end

  local function data_blocks(buffer, at, stop, sub, answer)
    while at + 4 <= stop do
      local size = buffer(at + 2, 2):uint()
      if buffer(at + 1, 1):uint() == 4 then size = math.floor(size / 8) end
      size = math.min(size, stop - at - 4)
      if answer then sub:add(f.result, buffer(at, 1)) end
      if size > 0 then sub:add(f.data, buffer(at + 4, size)) end
      at = at + 4 + size + size % 2
    end
  end

  local function unit(buffer, at, stop, sub)
    if stop - at < 10 or buffer(at, 1):uint() ~= 0x32 then
      if stop > at then sub:add(f.rest, buffer(at, stop - at)) end
      return "unknown unit"
    end
    local kind = buffer(at + 1, 1):uint()
    local answer = kind == 2 or kind == 3
    sub:add(f.kind, buffer(at + 1, 1))
    sub:add(f.reference, buffer(at + 4, 2))
    local parameters = buffer(at + 6, 2):uint()
    local first = at + (answer and 12 or 10)
    if answer and first <= stop then sub:add(f.error_code, buffer(at + 10, 2)) end
    if parameters < 2 or first + parameters > stop then return answer and "answer" or "request" end
    local func, count = buffer(first, 1):uint(), buffer(first + 1, 1):uint()
    sub:add(f.func, buffer(first, 1))
    sub:add(f.items, buffer(first + 1, 1))
    local says, data = {}, first + parameters
    for i = 0, count - 1 do
      local item = first + 2 + 12 * i
      if answer or item + 12 > data then break end
      says[#says + 1] = item_text(buffer(item, 12))
      sub:add(f.item, buffer(item, 12), says[#says])
    end
    if answer and func == 5 then
      for i = data, stop - 1 do sub:add(f.result, buffer(i, 1)) end
    else
      data_blocks(buffer, data, stop, sub, answer)
    end
    local verb = func == 4 and "read" or func == 5 and "write" or ("function " .. func)
    return (answer and "answer to " or "") .. verb .. (#says > 0 and " " or "") .. table.concat(says, "; ")
  end

  -- One telegram; how long it is and what it says.
  local function telegram(buffer, at, sub)
    local left, start = buffer:len() - at, buffer(at, 1):uint()
    sub:add(f.start, buffer(at, 1))
    if start == 0xE5 then return 1, "E5 received" end
    if start == 0xF9 then return 1, "F9 done" end
    if start == 0xDC and left >= 3 then return 3, "token" end
    local length
    if start == 0x10 and left >= 6 then length = 3
    elseif start == 0x68 and left >= 9 then length = buffer(at + 1, 1):uint() end
    local head = start == 0x68 and 4 or 1
    if not length or length < 3 or head + length + 2 > left then
      sub:add(f.rest, buffer(at)):add_proto_expert_info(fault, "no whole telegram")
      return left, "no whole telegram"
    end
    if start == 0x68 then sub:add(f.length, buffer(at + 1, 1)) end
    local link = at + head
    sub:add(f.to, buffer(link, 1))
    sub:add(f.from, buffer(link + 1, 1))
    sub:add(f.control, buffer(link + 2, 1))
    local says = "poll"
    if start == 0x68 then says = unit(buffer, link + 3, link + length, sub) end
    check(sub, fault, f.fcs, buffer(link + length, 1), hex2(buffer(link + length, 1):uint()), hex2(sum_of(buffer, link, link + length - 1)))
    return head + length + 2, string.format("%d to %d: %s", buffer(link + 1, 1):uint(), buffer(link, 1):uint(), says)
  end

  function proto.dissector(buffer, pinfo, tree)
    local sub = begin(proto, buffer, pinfo, tree, "PPI")
    local at, says = 0, {}
    while at < buffer:len() and #says < 64 do
      local size, text = telegram(buffer, at, sub)
      at, says[#says + 1] = at + size, text
    end
    info(pinfo, table.concat(says, "; "))
    return buffer:len()
  end
end

-- ---- Mitsubishi FX, the programming port

do
  local proto, f, fault = new_protocol("mitsubishi-fx", "Mitsubishi FX", {
    character = { ProtoField.string, "Character" },
    command = { ProtoField.string, "Command" },
    address = { ProtoField.string, "Address" },
    count = { ProtoField.string, "Bytes" },
    data = { ProtoField.string, "Data" },
    sum = { ProtoField.string, "Sum" },
    text = { ProtoField.string, "Frame" },
  })
  local ALONE = { [5] = "ENQ ready?", [6] = "ACK done, or ready", [0x15] = "NAK refused" }
  -- Longer spellings first.
  local COMMANDS = { { "E00", "extended read" }, { "E10", "extended write" }, { "E01", "program read" }, { "E11", "program write" },
    { "E7", "extended force on", true }, { "E8", "extended force off", true }, { "0", "read" }, { "1", "write" },
    { "7", "force on", true }, { "8", "force off", true } }

  function proto.dissector(buffer, pinfo, tree)
    local sub = begin(proto, buffer, pinfo, tree, "FX")
    local length, first = buffer:len(), buffer(0, 1):uint()
    if length == 1 and ALONE[first] then
      sub:add(f.character, buffer(0, 1), ALONE[first])
      info(pinfo, ALONE[first])
      return length
    end
    local text = buffer():string()
    local etx = text:find("\3", 1, true)
    if first ~= 2 or not etx or etx + 2 > length then
      sub:add(f.text, buffer()):add_proto_expert_info(fault, "no whole frame: STX, digits, ETX, sum")
      info(pinfo, "No whole frame")
      return length
    end
    local body, last = text:sub(2, etx - 1), etx - 1
    local says = "Answer"
    if pinfo.dst_port == 502 then
      says = "Request"
      for _, row in ipairs(COMMANDS) do
        local spelling, name, force = row[1], row[2], row[3]
        if body:sub(1, #spelling) == spelling then
          local at = 1 + #spelling
          sub:add(f.command, buffer(1, #spelling), spelling .. " " .. name)
          if at + 4 <= last then sub:add(f.address, buffer(at, 4)) end
          if not force and at + 6 <= last then sub:add(f.count, buffer(at + 4, 2)) end
          if not force and at + 6 < last then sub:add(f.data, buffer(at + 6, last - at - 6)) end
          says = "Request " .. name .. " " .. body:sub(#spelling + 1, #spelling + 4)
          break
        end
      end
    elseif last > 1 then
      sub:add(f.data, buffer(1, last - 1))
    end
    check(sub, fault, f.sum, buffer(etx, 2), text:sub(etx + 1, etx + 2), hex2(sum_of(buffer, 1, etx - 1)))
    info(pinfo, says)
    return length
  end
end

-- ---- DTC

do
  local proto, f, fault = new_protocol("dtc", "DTC", {
    compressed = { ProtoField.bool, "Compressed" },
    length = { ProtoField.uint16, "Length" },
    original = { ProtoField.uint16, "Length of the message" },
    codes = { ProtoField.bytes, "Codes of LZW" },
    address = { ProtoField.uint8, "Address" },
    command = { ProtoField.uint8, "Command", base.HEX, { [0] = "read", [1] = "write", [0x80] = "read refused", [0x81] = "write refused" } },
    code = { ProtoField.uint8, "Code of the refusal" },
    group = { ProtoField.string, "Group" },
    data = { ProtoField.bytes, "Data" },
    crc = { ProtoField.bytes, "CRC" },
    rest = { ProtoField.bytes, "Bytes" },
  })

  local MAX_ORIGINAL = 4096  -- bytes, as Fieldcast takes them
  local LAST_CODE = 4095

  -- What the codes stand for: LZW over nibbles. The codes 0 to 15 are the nibbles themselves; each code adds the string before it and its
  -- own first nibble as the next entry. Code k, counted from 0, has as many bits as the number 15 + k. Nothing: they are not that.
  local function decompressed(codes, size)
    local nibbles, start, length = {}, {}, {}
    local at, waiting, bits = 0, 0, 0
    local width, widest = 4, 16
    local last_start, last_length = 0, 0
    for k = 0, 2 * size do
      if #nibbles == 2 * size then break end
      local entry = 15 + k
      if entry >= widest and entry <= LAST_CODE then width, widest = width + 1, widest * 2 end
      while bits < width do
        if at == codes:len() then return end
        waiting, bits, at = waiting * 256 + codes(at, 1):uint(), bits + 8, at + 1
      end
      bits = bits - width
      local code = math.floor(waiting / 2 ^ bits)
      waiting = waiting % 2 ^ bits
      if k > 0 and entry <= LAST_CODE then start[entry], length[entry] = last_start, last_length + 1 end
      last_start, last_length = #nibbles + 1, code < 16 and 1 or length[code]
      if not last_length or #nibbles + last_length > 2 * size then return end
      if code < 16 then nibbles[last_start] = code end
      -- One by one: the newest entry ends with the nibble that this writes first.
      for i = 0, code < 16 and -1 or last_length - 1 do nibbles[last_start + i] = nibbles[start[code] + i] end
    end
    if at < codes:len() or waiting ~= 0 then return end
    for i = 1, #nibbles do nibbles[i] = string.format("%X", nibbles[i]) end
    return ByteArray.new(table.concat(nibbles))
  end

  local function message(buffer, at, size, sub, sent)
    if size < 4 then
      sub:add(f.rest, buffer(at, size)):add_proto_expert_info(fault, "too short")
      return "too short"
    end
    local command, stop = buffer(at + 1, 1):uint(), at + size - 2
    sub:add(f.address, buffer(at, 1))
    sub:add(f.command, buffer(at + 1, 1))
    local says = "address " .. buffer(at, 1):uint() .. (command % 128 == 0 and " read" or " write")
    local body = at + 2
    if command >= 0x80 and body < stop then
      sub:add(f.code, buffer(body, 1))
      says = says .. " refused"
    elseif sent and command == 0 then
      while body + 5 <= stop do
        local text = string.format("type %d:%d, count %d", buffer(body + 2, 1):uint(), buffer(body, 2):uint(), buffer(body + 3, 2):uint())
        sub:add(f.group, buffer(body, 5), text)
        body = body + 5
      end
    elseif body < stop then
      sub:add(f.data, buffer(body, stop - body))
    end
    local crc = crc16(buffer, at, stop - 1)
    check(sub, fault, f.crc, buffer(stop, 2), hex2(buffer(stop, 1):uint()) .. hex2(buffer(stop + 1, 1):uint()),
      hex2(crc % 256) .. hex2(math.floor(crc / 256)))
    return says
  end

  function proto.dissector(buffer, pinfo, tree)
    local sub = begin(proto, buffer, pinfo, tree, "DTC")
    local length, sent, says = buffer:len(), pinfo.dst_port == 502, "No whole packet"
    local size = length >= 3 and buffer(1, 2):uint() or 0
    if size == 0 or size + 3 > length or buffer(0, 1):uint() > 1 then
      sub:add(f.rest, buffer()):add_proto_expert_info(fault, "no whole packet")
    else
      local compressed = buffer(0, 1):uint() == 1
      sub:add(f.compressed, buffer(0, 1))
      sub:add(f.length, buffer(1, 2))
      if not compressed then
        says = message(buffer, 3, size, sub, sent)
      elseif size > 2 then
        sub:add(f.original, buffer(3, 2))
        local codes = sub:add(f.codes, buffer(5, size - 2))
        local original = buffer(3, 2):uint()
        local plain = original <= MAX_ORIGINAL and decompressed(buffer(5, size - 2), original)
        if plain and original > 0 then
          says = message(plain:tvb("Decompressed"), 0, original, sub, sent) .. string.format(", %d bytes in %d", original, size - 2)
        else
          codes:add_proto_expert_info(fault, "the codes do not give a message of this length")
          says = "compressed, broken"
        end
      else
        sub:add(f.rest, buffer(3, size)):add_proto_expert_info(fault, "too short")
      end
      if size + 3 < length then sub:add(f.rest, buffer(size + 3)) end
    end
    info(pinfo, (sent and "Request " or "Answer ") .. says)
    return length
  end
end

-- ---- S7-200 freeport

do
  local proto, f, fault = new_protocol("s7-freeport", "S7-200 freeport", {
    command = { ProtoField.string, "Command" },
    station = { ProtoField.string, "Station" },
    length = { ProtoField.string, "Length" },
    window = { ProtoField.string, "Window" },
    code = { ProtoField.string, "Code of the refusal" },
    check = { ProtoField.string, "Check" },
    text = { ProtoField.string, "Frame" },
  })
  local KINDS = { [17] = "Request", [12] = "Answer", [7] = "Refusal" }

  function proto.dissector(buffer, pinfo, tree)
    local sub = begin(proto, buffer, pinfo, tree, "Freeport")
    local length, text = buffer:len(), buffer():string()
    local kind = text:sub(1, 1) == "q" and text:sub(-1) == "Q" and KINDS[length]
    if not kind then
      sub:add(f.text, buffer()):add_proto_expert_info(fault, "no whole frame: from q to Q, 17, 12 or 7 characters")
      info(pinfo, "No whole frame")
      return length
    end
    local says = ""
    if kind == "Request" then
      says = text:sub(2, 2) == "W" and " read" or " write"  -- as the PLC sees it
      sub:add(f.command, buffer(1, 1))
      sub:add(f.station, buffer(2, 2))
      sub:add(f.length, buffer(4, 2))
    elseif kind == "Refusal" then
      sub:add(f.code, buffer(2, 2))
    end
    if kind ~= "Refusal" then sub:add(f.window, buffer(length - 11, 8)) end
    check(sub, fault, f.check, buffer(length - 3, 2), text:sub(-3, -2), hex2(xor_of(buffer, 1, length - 4)))
    info(pinfo, kind .. says)
    return length
  end
end

-- ---- Frames of declared protocols: their name stands in the column "Protocol"

do
  local proto, f = new_protocol("frame", "Frame of a declared protocol", {
    bytes = { ProtoField.bytes, "Bytes" },
    text = { ProtoField.string, "Text" },
  })

  function proto.dissector(buffer, pinfo, tree)
    local column = tostring(pinfo.cols.protocol)
    local sub = tree:add(proto, buffer())
    sub:add(f.bytes, buffer())
    local text = buffer():bytes():raw():gsub("[^\32-\126]", ".")
    sub:add(f.text, buffer(), text)
    if column ~= "" then pinfo.cols.protocol = column end
    info(pinfo, (pinfo.dst_port == 502 and "Request " or "Answer ") .. text)
    return buffer:len()
  end
end

-- ---- fieldcast/Sample inside RTPS over UDP
--
-- Wireshark 4.0 hands user data of RTPS to nobody, so this looks at each DATA submessage itself, and takes what is a Sample to the
-- last byte: it needs no discovery in the capture. What is encrypted (DDS Security), compressed or sent in fragments stays as it is.

do
  local QUALITIES = { [0] = "GOOD", "UNCERTAIN", "BAD_NO_ANSWER", "BAD_FRAME", "BAD_DEVICE_ERROR", "BAD_RANGE", "BAD_CONFIGURATION", "NOT_YET_READ" }
  local DATA = 0x15
  local proto, f = new_protocol("sample", "Fieldcast sample", {
    bus = { ProtoField.string, "Bus" },
    device = { ProtoField.string, "Device" },
    channel = { ProtoField.string, "Channel" },
    value = { ProtoField.string, "Value" },
    quality = { ProtoField.uint32, "Quality", base.DEC, QUALITIES },
    device_code = { ProtoField.uint16, "Device code" },
    acquired_at = { ProtoField.absolute_time, "Acquired at", base.UTC },
    sequence = { ProtoField.uint64, "Sequence" },
  })
  local payload_of_udp = Field.new("udp.payload")

  -- Reads CDR: each number stands at a multiple of its size. An error ends it: that is no sample.
  local function reader_of(buffer, little)
    local at, r = 0, {}
    function r.take(size)
      local start = at + (-at) % size
      if start + size > buffer:len() then error("cut") end
      at = start + size
      return buffer(start, size)
    end
    function r.number(size)
      local range = r.take(size)
      return little and range:le_uint() or range:uint(), range
    end
    function r.text(least, most)
      local length = r.number(4)
      if length < least + 1 or length > most + 1 or at + length > buffer:len() then error("no text") end
      at = at + length
      return buffer(at - length, length)
    end
    function r.name()
      local range = r.text(1, 64)
      if not range:string():match("^[%w%-_%.]+%z?$") then error("no name") end
      return range
    end
    -- Some writers fill up to four bytes.
    function r.over() return buffer:len() - at < 4 end
    return r
  end

  local VALUES = {
    [0] = function(r) local range = r.take(1) return range:uint() ~= 0 and "true" or "false", range end,
    function(r, little) local range = r.take(8) return tostring(little and range:le_int64() or range:int64()), range end,
    function(r, little) local range = r.take(8) return tostring(little and range:le_uint64() or range:uint64()), range end,
    function(r, little) local range = r.take(8) return string.format("%.7g", little and range:le_float() or range:float()), range end,
    function(r) local range = r.text(0, 256) return range:stringz(), range end,
  }

  local function parse(buffer, little)
    local r, rows, names = reader_of(buffer, little), {}, {}
    for _, key in ipairs({ "bus", "device", "channel" }) do
      local range = r.name()
      names[#names + 1] = range:stringz()
      rows[#rows + 1] = { f[key], range, range:stringz() }
    end
    local value, value_range = VALUES[(r.number(4))](r, little)
    rows[#rows + 1] = { f.value, value_range, value }
    local quality, quality_range = r.number(4)
    if quality > 7 then error("no quality") end
    rows[#rows + 1] = { f.quality, quality_range, quality }
    local code, code_range = r.number(2)
    rows[#rows + 1] = { f.device_code, code_range, code }
    local time = r.take(8)
    local nanoseconds = little and time:le_int64() or time:int64()
    rows[#rows + 1] = { f.acquired_at, time, NSTime((nanoseconds / 1000000000):tonumber(), (nanoseconds % 1000000000):tonumber()) }
    local sequence = r.take(8)
    rows[#rows + 1] = { f.sequence, sequence, little and sequence:le_uint64() or sequence:uint64() }
    if not r.over() then error("more than a sample") end
    return rows, string.format("%s = %s %s", table.concat(names, "/"), value, QUALITIES[quality])
  end

  -- The serialized data of a DATA submessage behind its four bytes of encapsulation; nothing: there is none.
  local function data_of(buffer, flags, little)
    local function number(at, size) return little and buffer(at, size):le_uint() or buffer(at, size):uint() end
    if buffer:len() < 24 or bit.band(flags, 0x04) == 0 then return end
    local at = 4 + number(2, 2)
    if bit.band(flags, 0x02) ~= 0 then  -- inline QoS, up to its sentinel
      while at + 4 <= buffer:len() and number(at, 2) ~= 1 do at = at + 4 + number(at + 2, 2) end
      at = at + 4
    end
    if at + 4 >= buffer:len() or buffer(at, 1):uint() ~= 0 or buffer(at + 1, 1):uint() > 1 then return end
    return buffer(at + 4):tvb(), buffer(at + 1, 1):uint() == 1
  end

  local function walk(buffer, tree)
    local at = 20
    while at + 4 <= buffer:len() do
      local flags = buffer(at + 1, 1):uint()
      local little = flags % 2 == 1
      local length = little and buffer(at + 2, 2):le_uint() or buffer(at + 2, 2):uint()
      if length == 0 or at + 4 + length > buffer:len() then length = buffer:len() - at - 4 end
      if buffer(at, 1):uint() == DATA and length > 0 then
        local data, data_little = data_of(buffer(at + 4, length):tvb(), flags, little)
        if data then
          local good, rows, says = pcall(parse, data, data_little)
          if good then
            local sub = tree:add(proto, data(), "Fieldcast sample: " .. says)
            for _, row in ipairs(rows) do sub:add(row[1], row[2], row[3]) end
          end
        end
      end
      at = at + 4 + length
    end
  end

  function proto.dissector(_, _, tree)
    local payload = payload_of_udp()
    if not payload or payload.range:len() < 24 or payload.range(0, 4):uint() ~= 0x52545053 then return end  -- "RTPS"
    walk(payload.range:tvb(), tree)
  end
  register_postdissector(proto)
end
