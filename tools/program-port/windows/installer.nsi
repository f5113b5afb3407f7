; Installer of fieldcast-port.exe for one computer. tools/windows.sh defines VERSION, FILES (folder of the files) and OUTPUT.
; It starts no service. To install without questions: setup.exe /S, to another folder also /D=C:\folder as the last word.
Unicode true
Target amd64-unicode
SetCompressor /SOLID lzma
SetDateSave off
Name "Fieldcast port ${VERSION}"
OutFile "${OUTPUT}"
InstallDir "$PROGRAMFILES64\Fieldcast"
RequestExecutionLevel admin
ManifestSupportedOS all
LicenseData "${FILES}/license.txt"
Page license
Page directory
Page instfiles
UninstPage uninstConfirm
UninstPage instfiles

!define UNINSTALL "Software\Microsoft\Windows\CurrentVersion\Uninstall\FieldcastPort"

Section
  SetShellVarContext all
  SetRegView 64
  SetOutPath "$INSTDIR"
  ; A session that runs keeps its program open.
  ClearErrors
  File "${FILES}/fieldcast-port.exe"
  IfErrors 0 +3
    MessageBox MB_ICONSTOP "fieldcast-port.exe is in use: end its sessions and services, then install again." /SD IDOK
    Abort
  File "${FILES}/license.txt"
  File "${FILES}/notices.txt"
  WriteUninstaller "$INSTDIR\uninstall.exe"
  CreateShortcut "$SMPROGRAMS\Fieldcast port.lnk" "$SYSDIR\cmd.exe" '/k "cd /d "$INSTDIR" && fieldcast-port --help"'
  WriteRegStr HKLM "${UNINSTALL}" "DisplayName" "Fieldcast port"
  WriteRegStr HKLM "${UNINSTALL}" "DisplayVersion" "${VERSION}"
  WriteRegStr HKLM "${UNINSTALL}" "Publisher" "Fieldcast"
  WriteRegStr HKLM "${UNINSTALL}" "UninstallString" '"$INSTDIR\uninstall.exe"'
  WriteRegDWORD HKLM "${UNINSTALL}" "NoModify" 1
  WriteRegDWORD HKLM "${UNINSTALL}" "NoRepair" 1
SectionEnd

; Services stay in the list of Windows; `fieldcast-port service remove NAME` removes them before.
Section "Uninstall"
  SetShellVarContext all
  SetRegView 64
  Delete "$INSTDIR\fieldcast-port.exe"
  Delete "$INSTDIR\license.txt"
  Delete "$INSTDIR\notices.txt"
  Delete "$INSTDIR\uninstall.exe"
  RMDir "$INSTDIR"
  Delete "$SMPROGRAMS\Fieldcast port.lnk"
  DeleteRegKey HKLM "${UNINSTALL}"
SectionEnd
