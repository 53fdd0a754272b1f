-- Wakes clipgs archive when a series is complete. It is a wake-up and nothing else: without it the worker finds the
-- series at its next look, some seconds later. In Orthanc's configuration:
--   "LuaScripts": ["/usr/share/clipgs/orthanc/clipgs.lua"]
-- The file is that of "wake" in the worker's rules, and the service makes it.
local wake = '/run/clipgs-archive.wake'

function OnStableSeries(series, tags, metadata)
  if tags['Manufacturer'] == 'clipgs' then
    return -- what the worker itself has put back
  end
  local file = io.open(wake, 'r+') -- never makes it
  if file then
    file:write('.')
    file:close()
  end
end
