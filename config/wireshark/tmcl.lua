-- Shows what 'tmclctl trace BUS -w FILE' has recorded.
--
--     wireshark -X lua_script:tmcl.lua bench.pcapng
--
-- Or put this file into the folder that Wireshark calls "Personal Lua Plugins". The five bytes
-- before those of the wire are described in libtmcl's tmcl/trace_file.hpp.

local commands = {
  [1] = "ROR", [2] = "ROL", [3] = "MST", [4] = "MVP", [5] = "SAP", [6] = "GAP", [7] = "STAP",
  [8] = "RSAP", [9] = "SGP", [10] = "GGP", [11] = "STGP", [12] = "RSGP", [13] = "RFS", [14] = "SIO",
  [15] = "GIO", [19] = "CALC", [20] = "COMP", [21] = "JC", [22] = "JA", [23] = "CSUB",
  [24] = "RSUB", [25] = "EI", [26] = "DI", [27] = "WAIT", [28] = "STOP", [29] = "SAC", [30] = "SCO",
  [31] = "GCO", [32] = "CCO", [33] = "CALCX", [34] = "AAP", [35] = "AGP", [36] = "CLE",
  [37] = "VECT", [38] = "RETI", [39] = "ACO", [40] = "CALCVV", [41] = "CALCVA", [42] = "CALCAV",
  [43] = "CALCVX", [44] = "CALCXV", [45] = "CALCV", [46] = "MVPA", [48] = "RST", [49] = "DJNZ",
  [50] = "ROLA", [51] = "RORA", [55] = "SIV", [56] = "GIV", [57] = "AIV", [64] = "UF0",
  [65] = "UF1", [66] = "UF2", [67] = "UF3", [68] = "UF4", [69] = "UF5", [70] = "UF6", [71] = "UF7",
  [80] = "CALL", [128] = "STOP_APPLICATION", [129] = "RUN_APPLICATION", [130] = "STEP_APPLICATION",
  [131] = "RESET_APPLICATION", [132] = "START_DOWNLOAD", [133] = "END_DOWNLOAD",
  [134] = "READ_TMCL_MEMORY", [135] = "GET_APPLICATION_STATUS", [136] = "GET_FIRMWARE_VERSION",
  [137] = "FACTORY_RESET", [138] = "TARGET_REACHED_EVENT", [139] = "ENTER_ASCII_MODE",
  [140] = "SECURITY_CODE", [141] = "BREAKPOINT", [142] = "RAM_DEBUG", [143] = "GET_IDS",
  [144] = "WRITE_USER_CHANNEL", [145] = "READ_USER_CHANNEL", [146] = "WRITE_MC",
  [147] = "WRITE_DRV", [148] = "READ_MC", [149] = "READ_DRV", [150] = "MEASURED_SPEED",
  [151] = "BOARD_ERROR", [152] = "BOARD_RESET", [157] = "GET_INFO", [160] = "WLAN0",
  [161] = "WLAN1", [162] = "WLAN2", [163] = "WLAN3", [170] = "GET_AP_MIN", [171] = "GET_AP_MAX",
  [172] = "OTP", [200] = "BOOT_ERASE_ALL", [201] = "BOOT_WRITE_BUFFER", [202] = "BOOT_WRITE_PAGE",
  [203] = "BOOT_GET_CHECKSUM", [204] = "BOOT_READ_MEMORY", [205] = "BOOT_START_APPLICATION",
  [206] = "BOOT_GET_INFO", [208] = "BOOT_WRITE_LENGTH", [242] = "ENTER_BOOTLOADER",
  [255] = "SOFTWARE_RESET",
}

local statuses = {
  [1] = "wrong_checksum", [2] = "invalid_command", [3] = "wrong_type", [4] = "invalid_value",
  [5] = "eeprom_locked", [6] = "command_not_available", [7] = "load_error", [8] = "write_protected",
  [9] = "maximum_exceeded", [10] = "download_not_possible", [11] = "chip_read_failed",
  [32] = "avr_not_ready", [100] = "ok", [101] = "command_loaded", [128] = "delayed",
  [129] = "active_communication",
}

local tmcl = Proto("tmcl", "Trinamic Motion Control Language")
local fields = {
  garbage = ProtoField.bool("tmcl.garbage", "Garbage"),
  reply = ProtoField.bool("tmcl.reply", "Reply"),
  can_id = ProtoField.uint32("tmcl.can_id", "CAN identifier", base.HEX),
  module = ProtoField.uint16("tmcl.module", "Module"),
  host = ProtoField.uint8("tmcl.host", "Host"),
  command = ProtoField.uint8("tmcl.command", "Command", base.DEC, commands),
  type = ProtoField.uint8("tmcl.type", "Type"),
  motor = ProtoField.uint8("tmcl.motor", "Motor or bank"),
  status = ProtoField.uint8("tmcl.status", "Status", base.DEC, statuses),
  value = ProtoField.int32("tmcl.value", "Value"),
}
for _, field in pairs(fields) do table.insert(tmcl.fields, field) end

local function name_in(names, number) return names[number] or tostring(number) end

-- What is behind the address: on CAN that is the identifier of a request.
local function show_request(tree, data, module)
  tree:add(fields.command, data(0, 1))
  tree:add(fields.type, data(1, 1))
  tree:add(fields.motor, data(2, 1))
  tree:add(fields.value, data(3, 4))
  return string.format("%d %s %d %d motor %d", module, name_in(commands, data(0, 1):uint()),
    data(1, 1):uint(), data(3, 4):int(), data(2, 1):uint())
end

local function show_reply(tree, data)
  tree:add(fields.module, data(0, 1))
  tree:add(fields.status, data(1, 1))
  tree:add(fields.command, data(2, 1))
  tree:add(fields.value, data(3, 4))
  return string.format("%d %s %s %d", data(0, 1):uint(), name_in(commands, data(2, 1):uint()),
    name_in(statuses, data(1, 1):uint()), data(3, 4):int())
end

function tmcl.dissector(buffer, packet, root)
  if buffer:len() < 6 then return end
  local flags = buffer(0, 1):uint()
  local function has(flag) return math.floor(flags / flag) % 2 == 1 end
  local is_reply, is_can, is_garbage = has(1), has(2), has(8)
  local data = buffer(5):tvb()
  local tree = root:add(tmcl, buffer())
  tree:add(fields.reply, buffer(0, 1), is_reply)
  packet.cols.protocol = "TMCL"
  packet.cols.src = is_reply and "module" or "host"
  packet.cols.dst = is_reply and "host" or "module"
  if is_can then tree:add(fields.can_id, buffer(1, 4)) end
  local begin = is_can and 0 or 1
  if is_garbage or data:len() < begin + 7 then
    tree:add(fields.garbage, buffer(0, 1), true)
    packet.cols.info = "garbage: " .. data():bytes():tohex(true, " ")
  elseif is_reply then
    if not is_can then tree:add(fields.host, data(0, 1)) end
    packet.cols.info = show_reply(tree, data(begin):tvb())
  else
    local module = is_can and buffer(1, 4) or data(0, 1)
    tree:add(fields.module, module)
    packet.cols.info = show_request(tree, data(begin):tvb(), module:uint())
  end
end

DissectorTable.get("wtap_encap"):add(wtap.USER0, tmcl)
