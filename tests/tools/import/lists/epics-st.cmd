# A Koyo DL205, as the examples of the modbus module have it, and a Delta VFD-E
< envPaths
epicsEnvSet("PLC", "Koyo1")
drvAsynIPPortConfigure("$(PLC)", "127.0.0.1:502", 0, 0, 1)
modbusInterposeConfig("$(PLC)", 0, 2000, 0)
# inputs X as bits and as words (octal, as the PLC counts), outputs Y
drvModbusAsynConfigure("X_Bit",  "$(PLC)", 41, 2,  04000, 040, 0, 100, "Koyo")
drvModbusAsynConfigure("X_Word", "$(PLC)", 41, 3, 040400, 010, 0, 100, "Koyo")
drvModbusAsynConfigure("Drive",  "$(PLC)", 42, 3, 0x2100, 0x20, "UINT16", 500, "Delta")
dbLoadTemplate("epics.substitutions")
dbLoadRecords("drive.db", "P=VFD:, PORT=Drive")
iocInit
