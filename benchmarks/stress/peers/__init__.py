"""The same families in Exudyn: functions of the same names, in modules of the same names."""
